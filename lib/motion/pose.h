// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a head looks, and where it looked when a frame was taken.
#pragma once

#include <array>

#include "motion/profile.h"

namespace cerberus::motion {

// One piece of a head's way: constant acceleration from `from` until `until`.
struct Pose {
  Time from{};
  Time until = kNever;
  AxisState pan, tilt;    // at `from`
  bool settled = true;    // stands where it was sent, nothing else is on the way
  bool measured = false;  // the head said so; else it is what it was told

  bool moving() const { return pan.moving() || tilt.moving(); }
  // The same piece seen from `time` on; held at its ends.
  Pose at(Time time) const;
};

// The last poses in order of time.
class PoseHistory {
 public:
  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  // Replaces what was known from pose.from on: a newer plan overrides an older one.
  void add(const Pose& pose);
  // Where the head looked at `time`: by the last piece that had begun; before the first one, as it began. Of an empty
  // history: straight ahead.
  Pose at(Time time) const;

 private:
  static constexpr unsigned kKept = 256;  // 5 s of a moving head at 50 Hz
  const Pose& nth_last(unsigned n) const { return poses_[(next_ + kKept - 1 - n) % kKept]; }

  std::array<Pose, kKept> poses_{};
  unsigned next_ = 0, count_ = 0;
};

}  // namespace cerberus::motion
