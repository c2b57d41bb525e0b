// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/zones.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "vision/detection/polygons.h"

namespace cerberus::vision {
namespace {

constexpr std::string_view kWords[] = {"include", "exclude"};
constexpr PolygonSyntax kSyntax{
    .property = "zones", .example = "include 0.1,0.1 0.9,0.1 0.9,0.9", .words = kWords, .world = false};

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

}  // namespace

std::string Zones::parse(std::string_view text) {
  std::vector<TypedPolygon> typed;
  if (std::string error = parse_polygons(text, kSyntax, typed); !error.empty()) return error;
  polygons_.clear();
  for (TypedPolygon& polygon : typed)
    polygons_.push_back({polygon.word == kWords[0], std::move(polygon.corners)});
  drawn_ = nowhere_ = false;
  return {};
}

void Zones::draw(MutableGrayView plane) const {
  const bool limited =
      std::any_of(polygons_.begin(), polygons_.end(), [](const Polygon& p) { return p.include; });
  std::vector<double> columns;
  for (int y = 0; y < plane.height; ++y) {
    std::uint8_t* row = plane.row(y);
    std::fill(row, row + plane.width, limited ? 0 : 255);
    for (const bool include : {true, false})  // excludes have the last word
      for (const Polygon& polygon : polygons_) {
        if (polygon.include != include) continue;
        crossings(polygon.corners, plane.size(), y + 0.5, columns);
        for (std::size_t i = 0; i + 1 < columns.size(); i += 2) {
          // Pixels whose centre x + 0.5 lies in [columns[i], columns[i + 1]).
          const int from = std::clamp(static_cast<int>(std::ceil(columns[i] - 0.5)), 0, plane.width);
          const int to = std::clamp(static_cast<int>(std::ceil(columns[i + 1] - 0.5)), from, plane.width);
          std::fill(row + from, row + to, include ? 255 : 0);
        }
      }
  }
}

void Zones::apply(MutableGrayView mask) {
  if (everywhere()) return;
  if (plane_.resize(mask.size()) || !drawn_) {
    draw(plane_.view());
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
