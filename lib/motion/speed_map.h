// SPDX-License-Identifier: LGPL-2.1-or-later
// What a head makes of a commanded speed, as a calibration measured it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace cerberus::motion {

struct SpeedPoint {
  double commanded = 0, actual = 0;  // radians a second, both above 0
  bool operator==(const SpeedPoint&) const = default;
};

// Straight lines through 0 and the points, the same in both directions; beyond the last point in its proportion. Without
// points a head turns as it is commanded.
class SpeedMap {
 public:
  SpeedMap() = default;
  // points: rising in both numbers; see is_valid().
  explicit SpeedMap(std::vector<SpeedPoint> points) : points_(std::move(points)) {}
  static bool is_valid(const std::vector<SpeedPoint>& points) {
    SpeedPoint last;
    for (const SpeedPoint& p : points) {
      if (!(p.commanded > last.commanded) || !(p.actual > last.actual) ||
          !std::isfinite(p.commanded + p.actual))
        return false;
      last = p;
    }
    return true;
  }

  const std::vector<SpeedPoint>& points() const { return points_; }
  // Radians a second, of any sign.
  double actual(double commanded) const {
    return convert(commanded, &SpeedPoint::commanded, &SpeedPoint::actual);
  }
  double command_for(double actual) const {
    return convert(actual, &SpeedPoint::actual, &SpeedPoint::commanded);
  }

 private:
  double convert(double speed, double SpeedPoint::* from, double SpeedPoint::* to) const {
    if (points_.empty()) return speed;
    const double size = std::abs(speed);
    SpeedPoint low;
    for (const SpeedPoint& high : points_) {
      if (size <= high.*from) {
        const double part = (size - low.*from) / (high.*from - low.*from);
        return std::copysign(low.*to + part * (high.*to - low.*to), speed);
      }
      low = high;
    }
    return speed * (low.*to / low.*from);
  }

  std::vector<SpeedPoint> points_;
};

}  // namespace cerberus::motion
