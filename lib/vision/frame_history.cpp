// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/frame_history.h"

#include <algorithm>

namespace cerberus::vision {
namespace {

double seconds_between(FrameHistory::Time from, FrameHistory::Time to) {
  return static_cast<double>((to - from).count()) / 1e9;
}

}  // namespace

void FrameHistory::lose() {
  if (++lost_ > parameters_.lost_pictures) drop();
}

std::optional<double> FrameHistory::repeat(std::optional<Time> time, double nominal, bool damaged) {
  if (!any_) return std::nullopt;
  ++repeats_;
  damage_ |= damaged;
  shown_ = time;
  if (time && previous_ && *time > *previous_) {
    const double seconds = seconds_between(*previous_, *time);
    held_ =
        std::max(held_, std::min(seconds, damaged ? parameters_.longest_damage : parameters_.longest_repeat));
    return seconds;
  }
  return repeats_ * (usual_ > 0 ? usual_ : nominal > 0 ? nominal : parameters_.unknown_distance);
}

FrameHistory::Step FrameHistory::next(std::optional<Time> time, double nominal) {
  if (!any_) usual_ = 0;  // the rhythm of a new scene is learnt anew
  const double rhythm = usual_ > 0 ? usual_ : nominal;
  Step step;
  step.backwards = any_ && time && stamp_ && *time < *stamp_;
  if (step.backwards &&
      seconds_between(*time, *stamp_) > std::max(parameters_.gap_seconds, parameters_.gap_factor * rhythm))
    usual_ = 0;
  else if (any_)
    follow(step, time, rhythm);
  step.broken = any_ && step.fresh;
  ordered_ = time && (step.fresh || (ordered_ && !step.backwards && late_ == 0));
  step.repeatable = !step.fresh && ordered_ && step.seconds <= parameters_.longest_repeat;
  if (step.fresh) {
    stamp_.reset();
    late_ = 0;
  }
  any_ = true;
  lost_ = repeats_ = 0;
  held_ = 0;
  damage_ = false;
  previous_ = shown_ = time;
  if (!time) return step;
  stamp_ = time;
  if (late_ == 0) clock_ = *time;
  return step;
}

// A stream without timestamps, one that loses them, and one whose stamps step back a little are taken as evenly spaced:
// there is no other information. After a step back the clock advances by the assumed steps, so that they add up to the
// time of the stamps once these are in order again.
void FrameHistory::follow(Step& step, std::optional<Time> time, double rhythm) {
  const double even = (1 + lost_ + repeats_) * rhythm;
  step.fresh = false;
  step.previous = previous_;
  step.seconds = even;
  if (!time || !previous_) {
    late_ = 0;
    return;
  }
  const double seconds = *time > clock_ ? seconds_between(clock_, *time) : 0;
  if (seconds <= std::max(parameters_.least_seconds, late_ > 0 ? even / 4 : 0)) {
    clock_ += Time(static_cast<Time::rep>(even * 1e9));
    if (++late_ > parameters_.late_frames) late_ = 0;
    return;
  }
  step.seconds = seconds;
  step.fresh = rhythm > 0 && (seconds - held_) / (1 + lost_) >
                                 std::max(parameters_.gap_seconds, parameters_.gap_factor * rhythm);
  if (step.fresh) {
    usual_ = seconds;  // caps that promise more frames than come must not make every frame a gap
    step.seconds = 0;
    step.previous.reset();
  } else if (late_ == 0 && !damage_) {  // the distance across damage is not the stream's own
    if (usual_ <= 0) usual_ = rhythm > 0 ? rhythm : seconds;
    // Faster is believed at once, so that a long distance learnt from a gap does not excuse the next gap.
    usual_ = seconds * parameters_.gap_factor < usual_ ? seconds
                                                       : usual_ + parameters_.smoothing * (seconds - usual_);
  }
  late_ = 0;
}

bool FrameHistory::misses_frames(std::optional<Time> time, double nominal) const {
  if (!any_ || !time || !shown_ || *time < *shown_) return false;
  const double expected = nominal > 0 ? nominal : usual_;
  return expected > 0 && seconds_between(*shown_, *time) > parameters_.missing_factor * expected;
}

}  // namespace cerberus::vision
