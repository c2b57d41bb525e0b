// SPDX-License-Identifier: LGPL-2.1-or-later
// How bright each place of a plan is: its lamps, those of the neighbouring spaces through the openings, and what comes
// from everywhere. 1: full.
#pragma once

#include <algorithm>
#include <vector>

#include "sim/house/floor_plan.h"

namespace cerberus::sim {

class Light {
 public:
  explicit Light(const FloorPlan& plan) { update(plan); }
  // After lamps were switched.
  void update(const FloorPlan& plan);
  double at(int space, double x, double y) const {
    const Map& map = maps_[space];
    const int i = std::clamp(int((x - map.left) * kCells), 0, map.columns - 1);
    const int j = std::clamp(int((y - map.top) * kCells), 0, map.rows - 1);
    return map.values[std::size_t(j) * map.columns + i];
  }

 private:
  static constexpr double kCells = 10;  // a metre
  struct Map {
    double left, top;
    int columns, rows;
    std::vector<float> values;
  };
  std::vector<Map> maps_;
};

}  // namespace cerberus::sim
