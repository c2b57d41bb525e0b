// SPDX-License-Identifier: LGPL-2.1-or-later
// At which running time a frame counts: its own, unless that is a single one that is far off (FrameHistory). Where there
// is a clock, it decides: a time that has passed and is newer than the last frame's is right, however long there was
// none. Not thread-safe.
#pragma once

#include <optional>
#include <utility>

#include "vision/frame_history.h"

namespace cerberus::vision {

// Whether the clock confirms a frame's time: it has passed by `now`, and is newer than that of the last frame.
inline bool clock_confirms(FrameHistory::Time time, std::optional<FrameHistory::Time> last,
                           std::optional<FrameHistory::Time> now) {
  return now && time <= *now && (!last || time > *last);
}

class ClockedTimes {
 public:
  using Time = FrameHistory::Time;

  // Running time begins anew (a flush).
  void forget() {
    history_.drop();
    marked_ = false;
  }
  // A segment or a gap lies before the next frame: its time is no outlier.
  void mark() { marked_ = true; }

  struct Frame {
    Time time;                 // running time of its own
    double nominal = 0;        // distance to the next one, seconds, 0: unknown
    bool marked = false;       // the source says that the stream does not go on
    std::optional<Time> last;  // at which the last frame counted
    std::optional<Time> now;   // running time by the clock, where the stream may be live
  };
  Time next(const Frame& frame) {
    const bool marked = std::exchange(marked_, false) || frame.marked;
    const bool confirmed = clock_confirms(frame.time, frame.last, frame.now);
    return history_.next(frame.time, frame.nominal, marked, confirmed).time.value_or(frame.time);
  }

 private:
  FrameHistory history_;
  bool marked_ = false;
};

}  // namespace cerberus::vision
