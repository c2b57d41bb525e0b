// SPDX-License-Identifier: LGPL-2.1-or-later
// Dead reckoning of a head that reports no position: the speeds that it was commanded, integrated from the time at which
// each takes effect.
//
//   position(t) = position(t0) + sum of speed_i x (time for which speed_i was in force until t)
//
// A speed takes effect at once: the ramp of a head is part of its dead time, which is measured to the middle of the
// ramp. Uncertainty is not estimated here (control/pose_estimate.h).
#pragma once

#include <array>

#include "motion/pan_tilt.h"
#include "motion/pose.h"

namespace cerberus::motion {

class Reckoning {
 public:
  // The head rests at `at` from `time` on; all speeds are dropped.
  void begin(Time time, const PanTilt& at);
  // From `time` on the head turns at these speeds, radians a second. Speeds for `time` and later are replaced.
  void turn(Time time, const PanTilt& speed);
  // The head is at `at` at `time`; the speeds stay, and the positions before and after are shifted.
  void place(Time time, const PanTilt& at);
  // The piece of constant speed at `time`, with from = time; until: the next known change of speed.
  Pose at(Time time) const;
  // The speeds that were commanded last.
  PanTilt last() const { return nth_last(0).speed; }

 private:
  struct Step {
    Time from{};
    PanTilt at, speed;  // at: the position at `from`
  };
  static constexpr unsigned kKept = 256;  // 5 s of a head that takes 50 commands a second
  const Step& nth_last(unsigned n) const { return steps_[(next_ + kKept - 1 - n) % kKept]; }
  void add(const Step& step);

  std::array<Step, kKept> steps_{};
  unsigned next_ = 1, count_ = 1;  // never empty
};

}  // namespace cerberus::motion
