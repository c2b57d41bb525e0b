// SPDX-License-Identifier: LGPL-2.1-or-later
// Angles: radians everywhere inside lib/, degrees in files, messages and on the command line. Pan and bearings are
// positive to the right (clockwise from above).
#pragma once

#include <cmath>
#include <numbers>

namespace cerberus::sensing {

// The only conversion, used for rule edges and for the pan angle alike: angles written as the same number of degrees
// are the same double in radians, so that a comparison at an edge is exact.
constexpr double radians(double degrees) {
  return degrees * (std::numbers::pi / 180);
}
constexpr double degrees(double radians) {
  return radians * (180 / std::numbers::pi);
}

// Returns the same direction in [-pi, pi). NaN and infinity become NaN.
inline double wrap(double radians) {
  if (radians >= -std::numbers::pi && radians < std::numbers::pi) return radians;
  const double wrapped =
      std::remainder(radians, 2 * std::numbers::pi);  // without a rounding error, in [-pi, pi]
  return wrapped == std::numbers::pi ? -std::numbers::pi : wrapped;
}

}  // namespace cerberus::sensing
