// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/frame_order.h"

#include <utility>

namespace cerberus::control {

void FrameOrder::forget() {
  history_.drop();
  marked_ = false;
}

FrameOrder::Step FrameOrder::next(const Frame& frame) {
  const bool newer = !frame.newest || frame.time > *frame.newest;
  if (!newer) {
    const bool late = *frame.newest - frame.time <= parameters_.back;
    const bool reached = frame.now && *frame.newest - *frame.now <= parameters_.ahead_of_clock;
    if (late || reached) return {};
  }
  const bool confirmed = newer && frame.now && frame.time <= *frame.now;
  const bool marked = std::exchange(marked_, false) || frame.marked;
  const vision::FrameHistory::Step step = history_.next(frame.time, frame.nominal, marked || confirmed);
  const Time taken = step.time.value_or(frame.time);
  if (!newer) return taken == frame.time ? Step{.taken = taken, .anew = true} : Step{};
  return frame.newest && taken <= *frame.newest ? Step{} : Step{.taken = taken};
}

FrameOrder::Step FrameOrder::gap(Time time, std::optional<Time> newest) {
  mark();
  return !newest || time > *newest ? Step{.taken = time} : Step{};
}

}  // namespace cerberus::control
