// SPDX-License-Identifier: LGPL-2.1-or-later
// The trajectory of one axis from its position and speed to rest at a target: at most four pieces of constant
// acceleration, which can be evaluated for every time from the start on.
//
//   speed  ^    ____            accelerate, cruise, brake: the fastest way under a limit of speed and acceleration
//          |   /    \.          (a trapezoid; a triangle where there is no room to cruise)
//          |  /      \.
//          +-/--------\---> time
//
// A velocity command is planned as a position command to the stop in its direction, at that speed. After every command,
// even without another one, the axis therefore comes to rest between its stops.
#pragma once

#include <array>
#include <cstdint>

#include "motion/head_limits.h"

namespace cerberus::motion {

struct AxisState {
  double position = 0;      // radians
  double speed = 0;         // radians a second
  double acceleration = 0;  // radians a second squared, until the piece ends

  bool moving() const { return speed != 0 || acceleration != 0; }
};

// A command to an axis.
struct AxisCommand {
  enum class Kind : std::uint8_t {
    hold,      // brake, and stay
    position,  // go to `value` (radians) at no more than `speed`
    velocity,  // turn at `value` (radians a second, the sign is the direction) as far as the stop
  };
  Kind kind = Kind::hold;
  double value = 0;
  double speed = 0;  // radians a second, of Kind::position
  bool operator==(const AxisCommand&) const = default;
};

class Plan {
 public:
  // A plan at rest.
  Plan() : Plan(0.0) {}
  explicit Plan(double position, Time start = Time{0})
      : start_(start), target_(position), low_(position), high_(position) {}

  // Plans from `state` at `start` according to `command`. A command that is not finite is planned as hold; a speed
  // above the limit is reduced to the limit, a target beyond a stop to the stop. The end is a multiple of `step`
  // (radians; 0: any position) if one lies between the stops. If the axis cannot brake before a stop at the permitted
  // acceleration (the limits have changed), it brakes harder, if necessary at once: no plan leads further beyond a stop
  // than its start.
  static Plan make(Time start, const AxisState& state, const AxisCommand& command, const AxisLimits& limits,
                   double step = 0);

  // Returns the state at `time`; at rest before start() and after end().
  AxisState at(Time time) const;
  // Returns the end of the piece at `time`; kNever if it does not end.
  Time piece_end(Time time) const;

  // The same motion, this far away (radians).
  void shift(double way);

  Time start() const { return start_; }
  Time end() const;
  double target() const { return target_; }  // position of rest, radians

 private:
  struct Piece {
    double seconds = 0;  // from the plan's start
    double length = 0;   // seconds
    double position = 0, speed = 0, acceleration = 0;
  };
  void add(double length, double acceleration, double& position, double& speed);
  void travel(double position, double speed, double target, double most, double acceleration);
  Time time_of(double seconds) const;

  Time start_;
  double target_, low_, high_;
  std::array<Piece, 4> pieces_{};
  int count_ = 0;
};

}  // namespace cerberus::motion
