// SPDX-License-Identifier: LGPL-2.1-or-later
// What a head may do, axis by axis. Radians and seconds; pan positive to the right, tilt positive up. Positions are a
// line: nothing wraps on it. Zero, straight ahead, always lies between the stops.
#pragma once

#include <chrono>
#include <string>

#include "sensing/angles.h"

namespace cerberus::motion {

using Time = std::chrono::nanoseconds;
constexpr Time kNever = Time::max();

constexpr double seconds(Time time) {
  return static_cast<double>(time.count()) * 1e-9;
}

struct AxisLimits {
  double from = 0, to = 0;  // the soft stops; equal: the axis does not move
  double speed = sensing::radians(90);
  double acceleration = sensing::radians(600);

  bool holds(double position) const { return position >= from && position <= to; }
  // The nearest position between the stops; NaN becomes 0.
  double clamp(double position) const;
  bool operator==(const AxisLimits&) const = default;
};

struct Limits {
  AxisLimits pan{sensing::radians(-170), sensing::radians(170)};
  AxisLimits tilt{sensing::radians(-45), sensing::radians(45)};
  bool operator==(const Limits&) const = default;
};

// No head turns further (ten turns of cable) or faster than this; who asks for more mistyped.
constexpr double kMostPosition = sensing::radians(3600);
constexpr double kMostSpeed = sensing::radians(3600);
constexpr double kMostAcceleration = sensing::radians(1e6);

// Empty, or what is wrong in words for a user, with the numbers in degrees: limits that exclude zero or are in the
// wrong order, a speed or an acceleration that is not above 0, anything that is not a number or absurd.
std::string check(const Limits& limits);
// Empty, or which of these positions lies beyond the stops, as above.
std::string check_start(const Limits& limits, double pan, double tilt);

struct Reach {
  double position = 0;   // between the stops
  bool limited = false;  // the bearing itself lies beyond them
};

// Where to turn to so as to look along `bearing` (any angle, it wraps): among the positions
// bearing + n 2 pi between the stops the one nearest to `position`; where there is none,
// the stop nearest to the bearing (equally near: the one nearest to `position`). So the
// limits decide the way round, not the shorter arc. A bearing that is not a number: stay.
Reach reach(double bearing, double position, const AxisLimits& limits);

}  // namespace cerberus::motion
