// SPDX-License-Identifier: LGPL-2.1-or-later
// Limits of a head for each axis. Radians and seconds; pan positive to the right, tilt positive up. Positions lie on a
// line: they do not wrap. Zero, straight ahead, always lies between the stops.
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

// Largest accepted limits: no head turns further (ten turns of cable) or faster, so that larger values are typing
// errors.
constexpr double kMostPosition = sensing::radians(3600);
constexpr double kMostSpeed = sensing::radians(3600);
constexpr double kMostAcceleration = sensing::radians(1e6);

// Returns an empty string, or an error text for the user, with the numbers in degrees: limits that exclude zero or are
// in the wrong order, a speed or an acceleration that is not above 0, a value that is not finite or beyond the
// constants above.
std::string check(const Limits& limits);
// Returns an empty string, or an error text as above that names the position (radians) beyond the stops.
std::string check_start(const Limits& limits, double pan, double tilt);

// Returns an empty string, or an error text as above for limits of an axis ("pan") beyond what `what` reaches: "the camera".
// why: what says so, in brackets: " (range)".
std::string beyond_reach(const std::string& axis, const AxisLimits& limits, double from, double to,
                         const std::string& what, const std::string& why = {});

struct Reach {
  double position = 0;   // between the stops
  bool limited = false;  // the bearing lies beyond the stops
};

// Returns the position at which the head points along `bearing` (any angle, it wraps): of the positions
// bearing + n 2 pi between the stops the one nearest to `position`; if there is none, the stop nearest to the bearing
// (equally near: the one nearest to `position`). The limits, not the shorter arc, decide the direction of the turn. A
// bearing that is not a number returns the present position.
Reach reach(double bearing, double position, const AxisLimits& limits);

}  // namespace cerberus::motion
