// SPDX-License-Identifier: LGPL-2.1-or-later
// When the frames of a stream are taken, in running time, and where frames are missing.
//
// After each frame a head publishes its motion until the next one, where the head takes that to be. Where frames are
// missing (lost ones, a variable rate, a decoder that was interrupted) the head needs an event in their place:
// otherwise it waits for a frame, and the next frame waits for it. Not thread-safe.
#pragma once

#include <algorithm>
#include <optional>

#include "motion/head_limits.h"

namespace cerberus::motion {

class FrameTimes {
 public:
  // Running time begins anew.
  void forget() { last_ = end_ = {}; }
  // When a frame with this running time is taken. Without one: when the last frame ended, zero at the start.
  Time taken(std::optional<Time> running) const { return running.value_or(end_.value_or(Time::zero())); }
  // The end of the last frame where a frame of `time` leaves a hole behind it; nothing: it follows at once.
  std::optional<Time> gap_begin(Time time) const { return end_ && time > *end_ ? end_ : std::nullopt; }
  // When the last frame began; nothing: there was none.
  std::optional<Time> last() const { return last_; }
  // A frame of `time` that lasts `length`. An unknown length (zero) counts as 1 ns: a gap begins later than a frame.
  void add(Time time, Time length) {
    last_ = time;
    end_ = time + std::max(length, Time(1));
  }

 private:
  std::optional<Time> last_, end_;  // begin and end of the last frame
};

}  // namespace cerberus::motion
