// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/zones/world_polygon.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sensing/angles.h"

namespace cerberus::vision {
namespace {

// Of the origin from the line from a to b.
double squared_distance(const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;
  const double along = length > 0 ? std::clamp((-a.x * dx - a.y * dy) / length, 0.0, 1.0) : 0.0;
  const double x = a.x + along * dx, y = a.y + along * dy;
  return x * x + y * y;
}

}  // namespace

PolygonPlace place_in_polygon(std::span<const Point> corners, Point at, Point scale, double reach) {
  const auto moved = [&](const Point& corner) {
    return Point{(corner.x - at.x) * scale.x, (corner.y - at.y) * scale.y};
  };
  bool inside = false;
  Point a = moved(corners.back());
  for (const Point& corner : corners) {
    const Point b = moved(corner);
    if (squared_distance(a, b) <= reach * reach) return PolygonPlace::border;
    if ((a.y <= 0) != (b.y <= 0) && a.x + (b.x - a.x) * (0 - a.y) / (b.y - a.y) > 0) inside = !inside;
    a = b;
  }
  return inside ? PolygonPlace::inside : PolygonPlace::outside;
}

WorldPolygon::WorldPolygon(std::span<const Point> corners)
    : corners_(corners.begin(), corners.end()), bearing_(sensing::radians(corners.front().x)) {
  double before = bearing_, at = 0;
  for (Point& corner : corners_) {
    const double bearing = sensing::radians(corner.x);
    at += sensing::wrap(bearing - std::exchange(before, bearing));
    corner = {at, sensing::radians(corner.y)};
  }
  const auto x = std::ranges::minmax(corners_, {}, &Point::x),
             y = std::ranges::minmax(corners_, {}, &Point::y);
  least_ = {x.min.x, y.min.y};
  most_ = {x.max.x, y.max.y};
}

PolygonPlace WorldPolygon::place(const Direction& at, double reach) const {
  if (least_.y - at.elevation > reach || most_.y - at.elevation < -reach) return PolygonPlace::outside;
  const double narrow = std::cos(at.elevation);
  // Bearings wrap once for the whole polygon, which may reach behind the camera on both sides.
  const double first = sensing::wrap(bearing_ - at.bearing);
  PolygonPlace found = PolygonPlace::outside;
  for (const double turn : {0.0, 2 * std::numbers::pi, -2 * std::numbers::pi}) {
    const double from = first + turn;
    if ((from + least_.x) * narrow > reach || (from + most_.x) * narrow < -reach) continue;
    const PolygonPlace place = place_in_polygon(corners_, {-from, at.elevation}, {narrow, 1}, reach);
    if (place == PolygonPlace::border) return place;
    if (place == PolygonPlace::inside) found = place;
  }
  return found;
}

}  // namespace cerberus::vision
