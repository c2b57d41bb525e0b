// SPDX-License-Identifier: LGPL-2.1-or-later
// Start and end of motion from frames with and without objects, with hysteresis. Motion starts with the first object
// and ends when no object was present for a hold time; an object that appears within that time continues the motion.
#pragma once

#include <chrono>
#include <optional>

namespace cerberus::vision {

// Returns the duration that a frame stands for: `step` if it is known (above 0), else the difference between its time
// and the last frame's if that is positive, else 40 ms (25 frames a second).
std::chrono::nanoseconds frame_step(std::chrono::nanoseconds step,
                                    std::optional<std::chrono::nanoseconds> time,
                                    std::optional<std::chrono::nanoseconds> last);

class MotionEvents {
 public:
  using Time = std::chrono::nanoseconds;
  enum class Change { none, started, ended };

  // Processes one frame and returns the change that it makes. `present`: the frame has an object. `step`: the duration
  // since the frame before, as for the tracker; 0 = unknown, as for a scene's first frame. frame_step() then derives it
  // from `time`, the frame's time if it has one. `hold`: time without any object after which the motion ends; 0 = the
  // first frame without one ends it. The step to the first frame without an object is part of this time, because the
  // object was last detected on the frame before.
  Change update(bool present, std::optional<Time> time, Time step, Time hold);
  // The time after the last frame at which motion ends if no further frame comes; nothing where no motion is in progress.
  // It is what is left of `hold`, but at least three frame steps: a late frame is no end.
  std::optional<Time> ends_after(Time hold) const;
  // Reports that no further frame comes. Returns `ended` if motion was in progress.
  Change end();
  // The last frame's time.
  std::optional<Time> last() const { return last_; }

 private:
  bool active_ = false;
  Time quiet_{};  // duration without any object
  Time step_{};   // of the last frame
  std::optional<Time> last_;
};

}  // namespace cerberus::vision
