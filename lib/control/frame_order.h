// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides at which running time a frame counts for a head, and which frames do not count: a head moves by frames that
// are newer than the last one alone. A single time that is far off is the stream's mistake, as of
// vision::ClockedTimes: ahead, the frame counts at the usual distance, so that the frames behind it are not older than
// it; back, the frame is left out. Not thread-safe.
#pragma once

#include <optional>

#include "motion/head_limits.h"
#include "vision/clocked_times.h"

namespace cerberus::control {

class FrameOrder {
 public:
  using Time = motion::Time;

  // Guarded by unit-frame_order. Neither was swept.
  struct Parameters {
    // Times that go back by more begin anew, where they do so at all; other frames are late ones. Chosen: that of
    // vision::FrameHistory.
    Time back = std::chrono::seconds(1);
    // A time that is later than the clock by more is none at which a live frame was taken. Chosen: beyond what a
    // camera's clock and a jitter buffer make of it.
    Time ahead_of_clock = std::chrono::seconds(1);
  };

  // Running time begins anew (a flush).
  void forget() { times_.forget(); }
  // A segment begins: the next frame's time is no outlier.
  void mark() { times_.mark(); }

  using Frame = vision::ClockedTimes::Frame;  // now: where the clock drives the head
  struct Step {
    std::optional<Time> taken;  // nullopt: the frame does not count
    bool anew = false;          // the times have begun anew before the last frame's, which was wrong
  };
  // Where the clock drives the head, times go back only from one that it has not reached.
  Step next(const Frame& frame);
  // A gap that the stream announces, from this time on: the time of the frame behind it is no outlier.
  Step gap(Time time, std::optional<Time> last);

 private:
  Parameters parameters_;
  vision::ClockedTimes times_;
};

}  // namespace cerberus::control
