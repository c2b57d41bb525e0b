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
}  // namespace

History::Step History::next(GstClockTime time, double nominal) {
  Step step;
  const bool timed = GST_CLOCK_TIME_IS_VALID(time);
  const bool backwards = timed && GST_CLOCK_TIME_IS_VALID(newest_) && time < newest_;
  if (any_ && !backwards) {
    if (timed && GST_CLOCK_TIME_IS_VALID(previous_)) {
      const double seconds = static_cast<double>(time - previous_) / GST_SECOND;
      if (usual_ <= 0) usual_ = nominal > 0 ? nominal : seconds;
      if (seconds <= std::max(kGapSeconds, kGapFactor * usual_)) {
        step = {false, seconds, previous_};
        // Faster is believed at once, so that a long distance learnt from a gap does not excuse the next gap.
        usual_ = seconds * kGapFactor < usual_ ? seconds : usual_ + kSmoothing * (seconds - usual_);
      } else {
        usual_ = seconds;  // caps that promise more frames than come must not make every frame a gap
      }
    } else {
      // A stream without timestamps, or one that loses them, is taken as evenly spaced: nothing says otherwise.
      step = {false, nominal, previous_};
    }
  }
  if (!any_ || backwards) usual_ = 0;  // the rhythm of the new scene is learnt anew
  if (step.fresh) newest_ = GST_CLOCK_TIME_NONE;
  any_ = true;
  previous_ = time;
  if (timed) newest_ = time;
  return step;
}

bool History::misses_frames(GstClockTime time, double nominal) const {
  if (!any_ || !GST_CLOCK_TIME_IS_VALID(time) || !GST_CLOCK_TIME_IS_VALID(previous_) || time < previous_)
    return false;
  const double expected = nominal > 0 ? nominal : usual_;
  return expected > 0 && static_cast<double>(time - previous_) / GST_SECOND > kHoleFactor * expected;
}

}  // namespace cerberus::plugin
