// SPDX-License-Identifier: LGPL-2.1-or-later
// The pan axis of a head as a machine: what its motor and its camera do with the commands that arrive. It makes no
// decision and knows nothing of a driver. Radians and seconds; steps of 1 ms.
//
//   a command takes effect dead_time (+- jitter) later, in the order of arrival
//   speed    -> the commanded one, at no more than `acceleration`; to a position with room to brake, sqrt(2 a distance)
//   camera   = clamp(camera, motor - play / 2, motor + play / 2), seen at multiples of `step`
//   commanded speed v of a head with a table: k = round(steps v / speed), true speed = scale x speed x (k / steps)^exponent
#pragma once

#include <deque>
#include <random>

#include "motion/profile.h"

namespace cerberus::sim {

using motion::Time;

struct HeadTraits {
  double speed = sensing::radians(90);          // a second, the fastest
  double acceleration = sensing::radians(300);  // a second squared
  double dead_time = .06;                       // seconds
  double jitter = 0;                            // seconds: of each command's dead time, to both sides
  double step = 0;                              // radians; 0: any position
  double play = 0;                              // radians between motor and camera
  double rate = 50;                             // commands a second that it takes
  bool turns_only = false;                      // it takes speeds, no positions
  int speeds = 0;                               // of its table; 0: any speed, turned as commanded
  double table_scale = 1, table_exponent = 1;
};

class PanHead {
 public:
  PanHead(const HeadTraits& traits, unsigned seed) : traits_(traits), random_(seed) {}

  // A command arrives. A position with a speed of 0 or less, or a position for a head that turns only, is a hold.
  void command(const motion::AxisCommand& command, Time now);
  void elapse(Time until);

  const HeadTraits& traits() const { return traits_; }
  // The speed of the table that a driver takes for the commanded one.
  double nearest_speed(double commanded) const;
  // What the head makes of a commanded speed.
  double true_speed(double commanded) const;
  double camera() const;                   // radians
  double motor() const { return motor_; }  // radians
  double speed() const { return speed_; }  // of the motor, a second
  // It turns, or a command to turn waits or is in force.
  bool busy() const;

 private:
  struct Coming {
    double due = 0;  // seconds
    motion::AxisCommand command;
  };
  double wanted_speed() const;

  HeadTraits traits_;
  std::mt19937 random_;
  std::deque<Coming> coming_;
  motion::AxisCommand command_;  // in force
  double time_ = 0;              // seconds
  double motor_ = 0, speed_ = 0, camera_ = 0;
};

}  // namespace cerberus::sim
