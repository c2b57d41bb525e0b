// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/head_limits.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "text/numbers.h"

namespace cerberus::motion {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// Formats degrees with 6 digits, which hides the rounding of the conversion to radians.
std::string degrees(double radians) {
  return text::significant(sensing::degrees(radians), 6).string();
}

std::string check(const std::string& axis, const AxisLimits& limits) {
  const std::string span =
      axis + "-min " + degrees(limits.from) + " and " + axis + "-max " + degrees(limits.to);
  if (!(std::abs(limits.from) <= kMostPosition && std::abs(limits.to) <= kMostPosition))
    return span + " are beyond any head (" + degrees(kMostPosition) + " degrees)";
  if (limits.from > limits.to) return span + " are in the wrong order";
  if (!limits.holds(0))
    return span + " exclude 0: the head could not return to where it looks straight ahead";
  if (!(limits.speed > 0 && limits.speed <= kMostSpeed))
    return "a " + axis + " speed of " + degrees(limits.speed) +
           " degrees a second is none: more than 0, at most " + degrees(kMostSpeed);
  if (!(limits.acceleration > 0 && limits.acceleration <= kMostAcceleration))
    return "a " + axis + " acceleration of " + degrees(limits.acceleration) +
           " degrees a second squared is none: more than 0, at most " + degrees(kMostAcceleration);
  return {};
}

std::string check_start(const std::string& axis, const AxisLimits& limits, double position) {
  if (limits.holds(position)) return {};
  return "start-" + axis + " " + degrees(position) + " is not between " + axis + "-min " +
         degrees(limits.from) + " and " + axis + "-max " + degrees(limits.to);
}

}  // namespace

double AxisLimits::clamp(double position) const {
  return std::isnan(position) ? 0 : std::clamp(position, from, to);
}

std::string check(const Limits& limits) {
  std::string wrong = check("pan", limits.pan);
  return wrong.empty() ? check("tilt", limits.tilt) : wrong;
}

std::string check_start(const Limits& limits, double pan, double tilt) {
  std::string wrong = check_start("pan", limits.pan, pan);
  return wrong.empty() ? check_start("tilt", limits.tilt, tilt) : wrong;
}

std::string beyond_reach(const std::string& axis, const AxisLimits& limits, double from, double to,
                         const std::string& what, const std::string& why) {
  constexpr double kHair = 1e-6;  // radians: rounding of degrees
  if (limits.from >= from - kHair && limits.to <= to + kHair) return {};
  return axis + "-min " + degrees(limits.from) + " and " + axis + "-max " + degrees(limits.to) +
         " are beyond what " + what + " reaches, " + degrees(from) + " to " + degrees(to) + why + ": set " +
         axis + "-min and " + axis + "-max";
}

Reach reach(double bearing, double position, const AxisLimits& limits) {
  const double here = limits.clamp(position);
  if (!std::isfinite(bearing)) return {here, false};

  // The candidate nearest to the head is moved between the stops by whole turns if it lies beyond them.
  double candidate = here + sensing::wrap(bearing - here);
  if (candidate < limits.from) candidate += kTurn * std::ceil((limits.from - candidate) / kTurn);
  if (candidate > limits.to) candidate -= kTurn * std::ceil((candidate - limits.to) / kTurn);
  if (limits.holds(candidate)) return {candidate, false};

  const double from = std::abs(sensing::wrap(bearing - limits.from));
  const double to = std::abs(sensing::wrap(bearing - limits.to));
  constexpr double kSame = 1e-9;
  const bool left = std::abs(from - to) > kSame ? from < to : here - limits.from <= limits.to - here;
  return {left ? limits.from : limits.to, true};
}

}  // namespace cerberus::motion
