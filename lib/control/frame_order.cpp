// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/frame_order.h"

namespace cerberus::control {

FrameOrder::Step FrameOrder::next(const Frame& frame) {
  const bool newer = !frame.last || frame.time > *frame.last;
  if (!newer) {
    const bool late = *frame.last - frame.time <= parameters_.back;
    const bool reached = frame.now && *frame.last - *frame.now <= parameters_.ahead_of_clock;
    if (late || reached) return {};
  }
  const Time taken = times_.next(frame);
  if (!newer) return taken == frame.time ? Step{.taken = taken, .anew = true} : Step{};
  return frame.last && taken <= *frame.last ? Step{} : Step{.taken = taken};
}

FrameOrder::Step FrameOrder::gap(Time time, std::optional<Time> last) {
  mark();
  return !last || time > *last ? Step{.taken = time} : Step{};
}

}  // namespace cerberus::control
