// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <algorithm>

namespace cerberus::motion {

// How far inside a soft limit the stop must be sent to a head, radians: the way that it goes until the stop takes
// effect, and what its pose may be wrong by. speed: radians a second towards the limit, less than 0 counts as 0;
// dead_time: seconds; uncertainty: radians. At most a quarter of `range`, the radians between the limits: a head that
// does not know its pose is kept to the middle half.
constexpr double stop_margin(double speed, double dead_time, double uncertainty, double range) {
  const double margin = std::max(0.0, speed) * std::max(0.0, dead_time) + std::max(0.0, uncertainty);
  return std::min(margin, std::max(0.0, range) / 4);
}

}  // namespace cerberus::motion
