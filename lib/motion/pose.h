// SPDX-License-Identifier: LGPL-2.1-or-later
// The pose of a head, and its pose at the time of a frame.
#pragma once

#include <array>

#include "motion/profile.h"

namespace cerberus::motion {

// One piece of a head's trajectory: constant acceleration from `from` until `until`.
struct Pose {
  Time from{};
  Time until = kNever;
  AxisState pan, tilt;     // at `from`
  bool settled = true;     // the head rests at its setpoint and no command is pending
  bool measured = false;   // from the head's position feedback; false: from the commands
  bool by_speeds = false;  // from the speeds that it was commanded, as its speed map has them

  double field_of_view =
      0;  // radians that the camera sees over the frame's width, as the head's zoom says; 0: it says
          // nothing; NaN: it has a zoom, and what it sees is not known

  bool moving() const { return pan.moving() || tilt.moving(); }
  // Returns the same piece with its state at `time`, which is limited to the piece.
  Pose at(Time time) const;
};

// The last poses in order of time.
class PoseHistory {
 public:
  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  // Adds a piece and drops the stored ones from pose.from on: a newer plan overrides an older one.
  void add(const Pose& pose);
  // Returns the pose at `time` from the last piece that had begun; before the first piece, its initial pose; for an
  // empty history, straight ahead.
  Pose at(Time time) const;

 private:
  static constexpr unsigned kKept = 256;  // 5 s of a moving head at 50 Hz
  const Pose& nth_last(unsigned n) const { return poses_[(next_ + kKept - 1 - n) % kKept]; }

  std::array<Pose, kKept> poses_{};
  unsigned next_ = 0, count_ = 0;
};

}  // namespace cerberus::motion
