// SPDX-License-Identifier: LGPL-2.1-or-later
// Motion started or ended: told from frames with and without objects, with hysteresis. It starts with the first object
// and ends when none was there for a while; an object that comes back in that while is the same motion.
#pragma once

#include <chrono>
#include <optional>

namespace cerberus::vision {

// The duration that a frame counts for: `step` where it is known (above 0), else the distance of its time from the
// last frame's where that is positive, else that of 25 frames a second.
std::chrono::nanoseconds frame_step(std::chrono::nanoseconds step,
                                    std::optional<std::chrono::nanoseconds> time,
                                    std::optional<std::chrono::nanoseconds> last);

class MotionEvents {
 public:
  using Time = std::chrono::nanoseconds;
  enum class Change { none, started, ended };

  // One frame. `present`: there is an object on it. `step`: what it counts for since the frame before, as for the
  // tracker; 0 where nobody knows, as on a scene's first frame: then `time`, the frame's own where it has one, tells
  // how long the gap was. Where that tells nothing either (times that run backwards or stand still) there are 25 frames
  // a second. `hold`: without any object, before the end; 0 = the first frame without one ends it. The time before the
  // first frame without an object counts: it was last seen on the frame before.
  Change update(bool present, std::optional<Time> time, Time step, Time hold);
  // No frame comes any more: ended, if it was not before.
  Change end();
  // The last frame's time.
  std::optional<Time> last() const { return last_; }

 private:
  bool active_ = false;
  Time quiet_{};  // without any object
  std::optional<Time> last_;
};

}  // namespace cerberus::vision
