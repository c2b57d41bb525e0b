// SPDX-License-Identifier: LGPL-2.1-or-later
// Polygons in directions of the world, and the test that polygons of the world and of the picture share.
#pragma once

#include <span>
#include <vector>

#include "vision/geometry/lens.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

enum class PolygonPlace {
  outside,
  border,  // the border is no farther than the reach
  inside,
};

// Returns the place of `at` relative to a polygon of at least one corner, filled even-odd. Distances are measured after
// x and y are multiplied by `scale`; `reach` is in that unit, 0 or more.
PolygonPlace place_in_polygon(std::span<const Point> corners, Point at, Point scale, double reach);

class WorldPolygon {
 public:
  // corners: at least one, degrees: pan to the right, tilt up. An edge goes the shorter way round.
  explicit WorldPolygon(std::span<const Point> corners);

  // reach: radians, at most a few degrees: angles are distances in the plane of pan cos(tilt) and tilt there.
  PolygonPlace place(const Direction& at, double reach) const;

 private:
  std::vector<Point> corners_;  // radians, right of the first corner and up
  double bearing_ = 0;          // of the first corner, radians
  Point least_, most_;          // of all corners
};

}  // namespace cerberus::vision
