// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/zones/zones.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vision/zones/polygons.h"

namespace cerberus::vision {
namespace {

constexpr std::string_view kWords[] = {"include", "exclude"};
constexpr PolygonSyntax kSyntax{.property = "zones",
                                .example = "include 0.1,0.1 0.9,0.1 0.9,0.9; exclude world -12,4 -5,4 -5,-6",
                                .words = kWords,
                                .world = true};

// Pixels a side of the blocks that are tested as a whole. Derived: within it directions are almost linear, and a
// picture of 320 x 240 has 1,200.
constexpr int kBlock = 8;
// Share by which angles between directions near one another may differ from distances in the plane of pan cos(tilt) and
// tilt. Derived: over a block of 8 pixels and 10 degrees the cosine changes by less.
constexpr double kSlack = 1.1;

// Columns, in pixels, where the polygon's edges cross the height y of a row of pixel centres; sorted. An edge
// owns its upper end and not its lower one, so that a corner is counted once.
void crossings(const std::vector<Point>& corners, Size size, double y, std::vector<double>& columns) {
  columns.clear();
  Point a = corners.back();
  for (const Point& b : corners) {
    const double ay = a.y * size.height, by = b.y * size.height;
    if ((ay <= y) != (by <= y)) columns.push_back((a.x + (b.x - a.x) * (y - ay) / (by - ay)) * size.width);
    a = b;
  }
  std::sort(columns.begin(), columns.end());
}

void fill_picture(MutableGrayView plane, const std::vector<Point>& corners, std::uint8_t value) {
  std::vector<double> columns;
  for (int y = 0; y < plane.height; ++y) {
    std::uint8_t* row = plane.row(y);
    crossings(corners, plane.size(), y + 0.5, columns);
    for (std::size_t i = 0; i + 1 < columns.size(); i += 2) {
      // Pixels whose centre x + 0.5 lies in [columns[i], columns[i + 1]).
      const int from = std::clamp(static_cast<int>(std::ceil(columns[i] - 0.5)), 0, plane.width);
      const int to = std::clamp(static_cast<int>(std::ceil(columns[i + 1] - 0.5)), from, plane.width);
      std::fill(row + from, row + to, value);
    }
  }
}

void fill_world(MutableGrayView plane, const WorldPolygon& polygon, const Zones::View& view,
                std::uint8_t value) {
  const double sx = static_cast<double>(view.frame.width) / plane.width,
               sy = static_cast<double>(view.frame.height) / plane.height;
  const auto place = [&](double x, double y, double reach) {
    return polygon.place(view.camera.direction({x * sx, y * sy}), reach);
  };
  // A pixel covers the largest angle in the middle of the picture.
  const double reach = kSlack * kBlock / 2 * std::hypot(sx, sy) / view.camera.lens.focal_length();
  for (int top = 0; top < plane.height; top += kBlock)
    for (int left = 0; left < plane.width; left += kBlock) {
      const PolygonPlace whole = place(left + kBlock / 2, top + kBlock / 2, reach);
      if (whole == PolygonPlace::outside) continue;
      const int bottom = std::min(top + kBlock, plane.height), right = std::min(left + kBlock, plane.width);
      for (int y = top; y < bottom; ++y)
        for (int x = left; x < right; ++x)
          if (whole == PolygonPlace::inside || place(x + 0.5, y + 0.5, 0) != PolygonPlace::outside)
            plane.at(x, y) = value;
    }
}

bool same(const Zones::View& a, const Zones::View& b) {
  return a.frame == b.frame && a.camera.pan == b.camera.pan && a.camera.tilt == b.camera.tilt &&
         a.camera.lens.focal_length() == b.camera.lens.focal_length();
}

}  // namespace

std::string Zones::parse(std::string_view text) {
  std::vector<TypedPolygon> typed;
  if (std::string error = parse_polygons(text, kSyntax, typed); !error.empty()) return error;
  polygons_.clear();
  in_world_ = false;
  for (TypedPolygon& polygon : typed) {
    Polygon& own = polygons_.emplace_back();
    own.include = polygon.word == kWords[0];
    if (polygon.world)
      own.world.emplace(polygon.corners);
    else
      own.corners = std::move(polygon.corners);
    in_world_ = in_world_ || polygon.world;
  }
  drawn_ = nowhere_ = false;
  return {};
}

void Zones::draw(MutableGrayView plane, const std::optional<View>& view) const {
  const bool placed = view && view->camera.lens.known();
  const auto includes = [](const Polygon& p) { return p.include; };
  const bool limited =
      std::ranges::any_of(polygons_, includes) &&
      (placed || std::ranges::none_of(polygons_, [&](const Polygon& p) { return includes(p) && p.world; }));
  for (int y = 0; y < plane.height; ++y)
    std::fill(plane.row(y), plane.row(y) + plane.width, limited ? 0 : 255);
  for (const bool include : {true, false})  // excludes have the last word
    for (const Polygon& polygon : polygons_) {
      const std::uint8_t value = include ? 255 : 0;
      if (polygon.include != include) continue;
      if (!polygon.world)
        fill_picture(plane, polygon.corners, value);
      else if (placed)
        fill_world(plane, *polygon.world, *view, value);
    }
}

bool Zones::contain(Point at, const std::optional<Direction>& direction) const {
  bool limited = false, included = false;
  for (const Polygon& polygon : polygons_) {
    if (polygon.world && !direction) {
      included = included || polygon.include;
      continue;
    }
    const bool inside =
        (polygon.world ? polygon.world->place(*direction, 0)
                       : place_in_polygon(polygon.corners, at, {1, 1}, 0)) != PolygonPlace::outside;
    if (inside && !polygon.include) return false;
    limited = limited || polygon.include;
    included = included || inside;
  }
  return included || !limited;
}

bool Zones::contain(Point pixel, Size frame, const std::optional<CameraOrientation>& camera) const {
  std::optional<Direction> direction;
  if (camera && camera->lens.known()) direction = camera->direction(pixel);
  return contain({pixel.x / frame.width, pixel.y / frame.height}, direction);
}

// Whether plane_ must be drawn anew for this view; it is from now on.
bool Zones::changed(const std::optional<View>& view) {
  if (!in_world_) return false;
  const bool as_before = view.has_value() == view_.has_value() && (!view || same(*view, *view_));
  view_ = view;
  return !as_before;
}

void Zones::apply(MutableGrayView mask, const std::optional<View>& view) {
  if (everywhere()) return;
  const bool turned = changed(view);
  if (plane_.resize(mask.size()) || !drawn_ || turned) {
    draw(plane_.view(), view);
    drawn_ = true;
    nowhere_ = true;
    for (int y = 0; y < mask.height && nowhere_; ++y) {
      const std::uint8_t* row = plane_.view().row(y);
      nowhere_ = std::find(row, row + mask.width, 255) == row + mask.width;
    }
  }
  for (int y = 0; y < mask.height; ++y) {
    std::uint8_t* row = mask.row(y);
    const std::uint8_t* counts = plane_.view().row(y);
    for (int x = 0; x < mask.width; ++x) row[x] &= counts[x];
  }
}

}  // namespace cerberus::vision
