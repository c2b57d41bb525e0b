// SPDX-License-Identifier: LGPL-2.1-or-later
// Dead reckoning of a head that reports no position: the speeds that it was commanded, integrated from the time at which
// each takes effect.
//
//   position(t) = position(t0) + sum of speed_i x (time for which speed_i was in force until t)
//
// A speed takes effect at once: the ramp of a head is part of its dead time, which is measured to the middle of the
// ramp. Where there is play between motor and camera, camera = clamp(camera, motor - play / 2, motor + play / 2), as in
// SimulatedHead. Uncertainty is not estimated here (control/pose_estimate.h).
#pragma once

#include <array>

#include "motion/pan_tilt.h"
#include "motion/pose.h"

namespace cerberus::motion {

class Reckoning {
 public:
  // Radians between motor and camera. begin() puts the motor into the middle of it.
  void set_play(const PanTilt& play) { half_play_ = {play.pan / 2, play.tilt / 2}; }
  // The head rests at `at` from `time` on; all speeds are dropped.
  void begin(Time time, const PanTilt& at);
  // From `time` on the head turns at these speeds, radians a second. Speeds for `time` and later are replaced.
  void turn(Time time, const PanTilt& speed);
  // The head is at `at` at `time`; the speeds stay, and the positions before and after are shifted.
  void place(Time time, const PanTilt& at);
  // The piece of constant speed at `time`, with from = time; until: the next known change of speed.
  // A head in its play stands.
  Pose at(Time time) const;
  // The speeds that were commanded last.
  PanTilt last() const { return nth_last(0).speed; }

 private:
  struct Step {
    Time from{};
    PanTilt motor, camera, speed;  // positions at `from`
  };
  static constexpr unsigned kKept = 256;  // 5 s of a head that takes 50 commands a second
  const Step& nth_last(unsigned n) const { return steps_[(next_ + kKept - 1 - n) % kKept]; }
  const Step& step_at(Time time, Time& end) const;
  void add(const Step& step);

  std::array<Step, kKept> steps_{};
  unsigned next_ = 1, count_ = 1;  // never empty
  PanTilt half_play_;
};

}  // namespace cerberus::motion
