// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/privacy/privacy_zones.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sensing/angles.h"
#include "vision/detection/polygons.h"

namespace cerberus::overlay {

namespace {

using vision::Point;

constexpr vision::PolygonSyntax kSyntax{
    .property = "masks", .example = "0,0 0.3,0 0.3,0.2; world -12,4 -5,4 -5,-6", .words = {}, .world = true};

// Share by which angles between directions near one another may differ from distances in the plane of pan cos(tilt) and
// tilt. Derived: over a block of 8 pixels and 10 degrees the cosine changes by less.
constexpr double kSlack = 1.1;

double squared_distance(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length = dx * dx + dy * dy;
  const double along =
      length > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length, 0.0, 1.0) : 0.0;
  const double x = a.x + along * dx - p.x, y = a.y + along * dy - p.y;
  return x * x + y * y;
}

// Returns whether (0, 0) lies within the polygon, or no farther from it than `reach`.
bool is_near(const std::vector<Point>& corners, double reach) {
  bool inside = false;
  Point a = corners.back();
  for (const Point& b : corners) {
    if (squared_distance({0, 0}, a, b) <= reach * reach) return true;
    if ((a.y <= 0) != (b.y <= 0) && a.x + (b.x - a.x) * (0 - a.y) / (b.y - a.y) > 0) inside = !inside;
    a = b;
  }
  return inside;
}

}  // namespace

std::string PrivacyZones::parse(std::string_view text) {
  std::vector<vision::TypedPolygon> typed;
  if (std::string error = vision::parse_polygons(text, kSyntax, typed); !error.empty()) return error;
  picture_.clear();
  world_.clear();
  for (vision::TypedPolygon& polygon : typed) {
    if (!polygon.world) {
      picture_.push_back(std::move(polygon.corners));
      continue;
    }
    WorldPolygon& own = world_.emplace_back();
    own.bearing = sensing::radians(polygon.corners.front().x);
    own.corners = std::move(polygon.corners);
    double before = own.bearing, at = 0;
    for (Point& corner : own.corners) {
      const double bearing = sensing::radians(corner.x);
      at += sensing::wrap(bearing - std::exchange(before, bearing));  // an edge goes the shorter way
      corner = {at, sensing::radians(corner.y)};
    }
    const auto x = std::ranges::minmax(own.corners, {}, &Point::x),
               y = std::ranges::minmax(own.corners, {}, &Point::y);
    own.least = {x.min.x, y.min.y};
    own.most = {x.max.x, y.max.y};
  }
  return {};
}

void PrivacyZones::cover(vision::Size size, const View& view, BlockMask& mask) const {
  mask.reset(size);
  std::vector<Point> moved;
  const double half = BlockMask::kBlock / 2.0, diagonal = half * std::numbers::sqrt2;
  for (const std::vector<Point>& polygon : picture_)
    for (int row = 0; row < mask.rows; ++row)
      for (int column = 0; column < mask.columns; ++column) {
        const Point centre{column * BlockMask::kBlock + half, row * BlockMask::kBlock + half};
        moved.clear();
        for (const Point& corner : polygon)
          moved.push_back({corner.x * size.width - centre.x, corner.y * size.height - centre.y});
        if (is_near(moved, diagonal)) mask.at(column, row) = 1;
      }
  if (!world_.empty()) cover_world(view, mask);
}

void PrivacyZones::cover_world(const View& view, BlockMask& mask) const {
  const vision::Lens lens(view.field_of_view, mask.frame);
  if (!view.posed || !lens.known() || !std::isfinite(view.pan + view.tilt + view.margin)) {
    std::ranges::fill(mask.covered, std::uint8_t{1});
    return;
  }
  const double half = BlockMask::kBlock / 2.0;
  // A pixel covers the largest angle in the middle of the picture.
  const double reach = kSlack * (view.margin + half * std::numbers::sqrt2 / lens.focal_length());
  std::vector<Point> moved;
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.columns; ++column) {
      if (mask.at(column, row)) continue;
      const Point centre{column * BlockMask::kBlock + half, row * BlockMask::kBlock + half};
      const vision::Direction at = lens.direction(centre, view.pan, view.tilt);
      const double narrow = std::cos(at.elevation);
      for (const WorldPolygon& polygon : world_) {
        if (polygon.least.y - at.elevation > reach || polygon.most.y - at.elevation < -reach) continue;
        // Bearings wrap once for the whole polygon, which may reach behind the camera on both sides.
        const double first = sensing::wrap(polygon.bearing - at.bearing);
        for (const double turn : {0.0, 2 * std::numbers::pi, -2 * std::numbers::pi}) {
          const double from = first + turn;
          if ((from + polygon.least.x) * narrow > reach || (from + polygon.most.x) * narrow < -reach)
            continue;
          moved.clear();
          for (const Point& corner : polygon.corners)
            moved.push_back({(from + corner.x) * narrow, corner.y - at.elevation});
          if (is_near(moved, reach)) mask.at(column, row) = 1;
        }
      }
    }
}

}  // namespace cerberus::overlay
