// SPDX-License-Identifier: LGPL-2.1-or-later
#include "history.hpp"

#include <algorithm>

namespace cerberus::plugin {
namespace {
// A hole this many times wider than the usual distance, and at least this wide in seconds, is another scene: what
// stood still has moved too far for a difference of neighbours to mean anything. Live cameras that stall for a
// moment stay below it, cameras that send a frame every few seconds are judged by their own rhythm.
constexpr double kGapFactor = 3.0;
constexpr double kGapSeconds = 0.25;
constexpr double kSmoothing = 0.1;
constexpr double kHoleFactor = 1.5;  // of the usual distance: from here a frame is missing
constexpr double kLeast = 1e-4;      // s: no camera is faster, whatever its stamps say
constexpr int kLate = 8;             // frames that are older than believed, before they are believed
constexpr int kLost = 5;             // pictures in a row that may be lost within a scene

double seconds_between(GstClockTime from, GstClockTime to) {
  return static_cast<double>(to - from) / GST_SECOND;
}
}  // namespace

void History::lose() {
  if (++lost_ > kLost) drop();
}

std::optional<double> History::repeat(GstClockTime time, double nominal) {
  if (!any_) return std::nullopt;
  ++repeats_;
  if (GST_CLOCK_TIME_IS_VALID(time) && GST_CLOCK_TIME_IS_VALID(previous_) && time > previous_)
    return seconds_between(previous_, time);
  constexpr double kUsual = .04;
  return repeats_ * (usual_ > 0 ? usual_ : nominal > 0 ? nominal : kUsual);
}

History::Step History::next(GstClockTime time, double nominal) {
  if (!any_) usual_ = 0;  // the rhythm of a new scene is learnt anew
  const bool timed = GST_CLOCK_TIME_IS_VALID(time);
  const double rhythm = usual_ > 0 ? usual_ : nominal;
  Step step;
  step.backwards = any_ && timed && GST_CLOCK_TIME_IS_VALID(stamp_) && time < stamp_;
  if (step.backwards && seconds_between(time, stamp_) > std::max(kGapSeconds, kGapFactor * rhythm))
    usual_ = 0;
  else if (any_)
    follow(step, time, timed, rhythm);
  step.broken = any_ && step.fresh;
  if (step.fresh) {
    stamp_ = clock_ = GST_CLOCK_TIME_NONE;
    late_ = 0;
  }
  any_ = true;
  lost_ = repeats_ = 0;
  previous_ = time;
  if (!timed) return step;
  stamp_ = time;
  if (late_ == 0) clock_ = time;
  return step;
}

// A stream without timestamps, one that loses them, and one whose stamps step back a little are taken as evenly spaced:
// there is no other information. After a step back the clock advances by the assumed steps, so that they add up to the
// time of the stamps once these are in order again.
void History::follow(Step& step, GstClockTime time, bool timed, double rhythm) {
  const double even = (1 + lost_) * rhythm;
  step.fresh = false;
  step.previous = previous_;
  step.seconds = even;
  if (!timed || !GST_CLOCK_TIME_IS_VALID(previous_)) {
    late_ = 0;
    return;
  }
  const double seconds = time > clock_ ? seconds_between(clock_, time) : 0;
  if (seconds <= std::max(kLeast, late_ > 0 ? even / 4 : 0)) {
    clock_ += static_cast<GstClockTime>(even * GST_SECOND);
    if (++late_ > kLate) late_ = 0;
    return;
  }
  step.seconds = seconds;
  step.fresh = rhythm > 0 && seconds / (1 + lost_) > std::max(kGapSeconds, kGapFactor * rhythm);
  if (step.fresh) {
    usual_ = seconds;  // caps that promise more frames than come must not make every frame a gap
    step.seconds = 0;
    step.previous = GST_CLOCK_TIME_NONE;
  } else if (late_ == 0) {
    if (usual_ <= 0) usual_ = rhythm > 0 ? rhythm : seconds;
    // Faster is believed at once, so that a long distance learnt from a gap does not excuse the next gap.
    usual_ = seconds * kGapFactor < usual_ ? seconds : usual_ + kSmoothing * (seconds - usual_);
  }
  late_ = 0;
}

bool History::misses_frames(GstClockTime time, double nominal) const {
  if (!any_ || !GST_CLOCK_TIME_IS_VALID(time) || !GST_CLOCK_TIME_IS_VALID(previous_) || time < previous_)
    return false;
  const double expected = nominal > 0 ? nominal : usual_;
  return expected > 0 && seconds_between(previous_, time) > kHoleFactor * expected;
}

}  // namespace cerberus::plugin
