// SPDX-License-Identifier: LGPL-2.1-or-later
// The steps of one motor: a ramped trajectory (motion/profile.h) quantised into single steps, each with its absolute
// deadline. No I/O and no clock: time is CLOCK_MONOTONIC as a parameter.
//
// The motor stands at angle(n) = origin + n step after n steps. The step from n to n + 1 is due when the planned angle
// passes the middle between both, so that the motor is never further than half a step from its plan. A deadline is the
// root of the plan's own piece of constant acceleration,
//   dt = 2 D / (u + sqrt(u^2 + 2 a D)),   D: way to the middle, u: speed, a: acceleration, all in the direction of motion
// and is counted from the plan's start: errors do not accumulate.
//
// Backlash B is play between motor and load: turning right the motor pushes the load at its own angle, turning left it
// pushes from the other side of the gap, at its angle + B. A plan to the left therefore ends at the load's target - B,
// and the load's angle is derived from the executed steps: load = clamp(load, motor, motor + B).
#pragma once

#include <cstdint>

#include "motion/profile.h"

namespace cerberus::drivers {

using motion::Time;

struct StepGeometry {
  double step = 0;        // radians of the load for one step, > 0
  double backlash = 0;    // radians of play between motor and load, >= 0
  Time least_interval{};  // between two executed steps: what the motor follows at most; > 0
};

class StepSchedule {
 public:
  explicit StepSchedule(const StepGeometry& geometry) : geometry_(geometry) {}

  // The load looks along `angle` (radians) now; the motor is not moved, and rests.
  void place(double angle);
  // Plans `command` from the present planned state. A speed above step / least_interval is reduced to it.
  void command(Time now, const motion::AxisCommand& command, const motion::AxisLimits& limits);
  // Drops the steps that are still to come: the motor rests where the executed ones brought it.
  void cut();

  // Deadline of the next step; motion::kNever: the motor rests. Not before the last executed step + least_interval.
  Time next() const;
  // When the next step was planned, without regard to the last executed one.
  Time planned() const { return next_; }
  int direction() const { return direction_; }  // of the next step: 1 right, -1 left, 0 none
  // The next step was executed at `now`.
  void advance(Time now);

  std::int64_t count() const { return count_; }  // executed steps, right minus left; never reset
  double load() const { return load_; }          // radians, from the executed steps
  double speed(Time now) const { return plan_.at(now).speed; }
  bool moving() const { return direction_ != 0; }

 private:
  double motor() const { return origin_ + static_cast<double>(count_) * geometry_.step; }
  void find(Time from);

  StepGeometry geometry_;
  motion::Plan plan_;  // of the motor, relative to origin_, so that rest positions are whole steps
  double origin_ = 0;  // radians: the motor's angle at count 0
  double load_ = 0;    // radians
  std::int64_t count_ = 0;
  int direction_ = 0;
  Time next_ = motion::kNever, executed_ = Time::min() / 2;
};

}  // namespace cerberus::drivers
