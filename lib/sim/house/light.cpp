// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/light.h"

#include <cmath>

namespace cerberus::sim {
namespace {

constexpr double kEverywhere = .38;  // of full light
constexpr double kLamp = .62;        // below a lamp of strength 1 that hangs 1.9 m above
constexpr double kAbove = 1.9;       // metres: a lamp over what it lights
constexpr double kThroughDoors = .25;
constexpr double kFull = 1.12;

bool leads(const Space& from, int to) {
  return std::ranges::any_of(from.openings, [&](const Opening& o) { return o.space == to; });
}

}  // namespace

void Light::update(const FloorPlan& plan) {
  maps_.clear();
  for (std::size_t s = 0; s < plan.spaces.size(); ++s) {
    const Space& space = plan.spaces[s];
    const Rectangle& area = space.area;
    Map map{area.left,
            area.top,
            int((area.right - area.left) * kCells) + 1,
            int((area.bottom - area.top) * kCells) + 1,
            {}};
    map.values.resize(std::size_t(map.columns) * map.rows);
    for (int j = 0; j < map.rows; ++j)
      for (int i = 0; i < map.columns; ++i) {
        double sum = kEverywhere;
        for (const Lamp& lamp : plan.lamps) {
          if (!lamp.on) continue;
          const bool here = lamp.space == int(s);
          if (!here && !leads(space, lamp.space)) continue;
          const double x = map.left + i / kCells - lamp.x, y = map.top + j / kCells - lamp.y;
          const double square = x * x + y * y + kAbove * kAbove;
          // Lambert's cosine and the square of the distance.
          sum += kLamp * lamp.strength * (here ? 1 : kThroughDoors) * std::pow(kAbove * kAbove / square, 1.5);
        }
        map.values[std::size_t(j) * map.columns + i] = float(std::min(sum, kFull));
      }
    maps_.push_back(std::move(map));
  }
}

}  // namespace cerberus::sim
