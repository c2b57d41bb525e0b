// SPDX-License-Identifier: LGPL-2.1-or-later
// The way of one axis from where it is and how fast it is to rest somewhere else: at most four pieces of constant
// acceleration, known for every time from its start on.
//
//   speed  ^    ____            accelerate, cruise, brake: the fastest way under a limit of speed and acceleration
//          |   /    \.          (a trapezoid; a triangle where there is no room to cruise)
//          |  /      \.
//          +-/--------\---> time
//
// A velocity is the same thing: the way to the stop in its direction, at that speed. So whatever is commanded, and if
// nothing is ever commanded again, the axis ends at rest between its stops.
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

// What an axis is told.
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
  // At rest, for ever.
  Plan() : Plan(0.0) {}
  explicit Plan(double position, Time start = Time{0})
      : start_(start), target_(position), low_(position), high_(position) {}

  // From `state` at `start` according to `command`. Numbers that are none are taken as hold; a speed above the limit as
  // the limit; a target beyond a stop as the stop. The end is a multiple of `step` (0: any position) where one lies
  // between the stops. A state that cannot be stopped before the stop at the permitted acceleration (the limits have
  // changed) is braked harder, in no time if need be: no plan leads further out than where it begins.
  static Plan make(Time start, const AxisState& state, const AxisCommand& command, const AxisLimits& limits,
                   double step = 0);

  // At rest before start() and after end().
  AxisState at(Time time) const;
  // When the piece that holds at `time` ends; kNever: not at all.
  Time piece_end(Time time) const;

  Time start() const { return start_; }
  Time end() const;
  double target() const { return target_; }  // where it comes to rest

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
