// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/privacy/privacy_zones.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "vision/zones/polygons.h"

namespace cerberus::overlay {

namespace {

using vision::Point;

constexpr vision::PolygonSyntax kSyntax{
    .property = "masks", .example = "0,0 0.3,0 0.3,0.2; world -12,4 -5,4 -5,-6", .words = {}, .world = true};

// Share by which angles between directions near one another may differ from distances in the plane of pan cos(tilt) and
// tilt. Derived: over a block of 8 pixels and 10 degrees the cosine changes by less.
constexpr double kSlack = 1.1;

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
    world_.emplace_back(polygon.corners);
  }
  return {};
}

void PrivacyZones::cover(vision::Size size, const View& view, BlockMask& mask) const {
  mask.reset(size);
  const double half = BlockMask::kBlock / 2.0, diagonal = half * std::numbers::sqrt2;
  const Point scale{double(size.width), double(size.height)};
  for (const std::vector<Point>& polygon : picture_)
    for (int row = 0; row < mask.rows; ++row)
      for (int column = 0; column < mask.columns; ++column) {
        const Point centre{column * BlockMask::kBlock + half, row * BlockMask::kBlock + half};
        const Point at{centre.x / scale.x, centre.y / scale.y};
        if (vision::place_in_polygon(polygon, at, scale, diagonal) != vision::PolygonPlace::outside)
          mask.at(column, row) = 1;
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
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.columns; ++column) {
      if (mask.at(column, row)) continue;
      const Point centre{column * BlockMask::kBlock + half, row * BlockMask::kBlock + half};
      const vision::Direction at = lens.direction(centre, view.pan, view.tilt);
      mask.at(column, row) = std::ranges::any_of(world_, [&](const vision::WorldPolygon& polygon) {
        return polygon.place(at, reach) != vision::PolygonPlace::outside;
      });
    }
}

}  // namespace cerberus::overlay
