// SPDX-License-Identifier: LGPL-2.1-or-later
// Which blocks of a picture must not be seen: polygons in fractions of the picture, and polygons in degrees of the world,
// which move through the picture as the camera turns.
//
//   masks="0,0 0.3,0 0.3,0.2 0,0.2; world -12,4 -5,4 -5,-6 -12,-6"
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "overlay/privacy/block_mask.h"
#include "vision/geometry/lens.h"
#include "vision/zones/world_polygon.h"

namespace cerberus::overlay {

class PrivacyZones {
 public:
  // Where the camera looks, as far as that is known.
  struct View {
    double field_of_view = 0;  // radians over the picture's width; 0: unknown
    bool posed = false;        // pan and tilt are known
    double pan = 0, tilt = 0;  // radians
    double margin = 0;         // radians by which they may be wrong
  };

  // Replaces the polygons. Returns an empty string, or what is wrong, and keeps the polygons it had.
  std::string parse(std::string_view text);
  bool empty() const { return picture_.empty() && world_.empty(); }
  bool need_pose() const { return !world_.empty(); }

  // Covers every block of a picture of `size` in which some pixel may lie in a polygon, and no block that is farther
  // from all of them than the margin and its own diagonal. Polygons of the world cover the whole picture where the
  // view is not known.
  void cover(vision::Size size, const View& view, BlockMask& mask) const;

 private:
  void cover_world(const View& view, BlockMask& mask) const;

  std::vector<std::vector<vision::Point>> picture_;  // fractions
  std::vector<vision::WorldPolygon> world_;
};

}  // namespace cerberus::overlay
