// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides at which running time a frame counts for a head, and which frames do not count: a head moves by frames that
// are newer than the last one alone. A single time that is far off is the stream's mistake, as of
// vision::FrameHistory: ahead, the frame counts at the usual distance, so that the frames behind it are not older than
// it; back, the frame is left out. Not thread-safe.
#pragma once

#include <optional>

#include "motion/head_limits.h"
#include "vision/frame_history.h"

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
  void forget();
  // A segment begins: the next frame's time is no outlier.
  void mark() { marked_ = true; }

  struct Frame {
    Time time;                   // running time of its own
    double nominal = 0;          // distance to the next one, seconds, 0: unknown
    bool marked = false;         // the source says that the stream does not go on
    std::optional<Time> newest;  // at which the last frame counted
    std::optional<Time> now;     // running time by the clock, where that drives the head
  };
  struct Step {
    std::optional<Time> taken;  // nullopt: the frame does not count
    bool anew = false;          // the times have begun anew before the last frame's, which was wrong
  };
  // Where the clock drives the head, it decides: a time that has passed and is newer than the last frame's is right,
  // however long there was none, and times go back only from one that the clock has not reached.
  Step next(const Frame& frame);
  // A gap that the stream announces, from this time on: the time of the frame behind it is no outlier.
  Step gap(Time time, std::optional<Time> newest);

 private:
  Parameters parameters_;
  vision::FrameHistory history_;
  bool marked_ = false;
};

}  // namespace cerberus::control
