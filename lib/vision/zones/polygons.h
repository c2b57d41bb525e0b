// SPDX-License-Identifier: LGPL-2.1-or-later
// Polygons as users type them in properties: parted by `;` (or a line break), corners x,y parted by blanks. Decimal
// points, whatever the locale.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vision/geometry/transform.h"

namespace cerberus::vision {

struct TypedPolygon {
  std::string_view word;  // of PolygonSyntax::words, if any
  // In degrees of the world (pan to the right, -180 to 180, and tilt up, -90 to 90); else in fractions of the picture (x to
  // the right and y downwards, 0 to 1).
  bool world = false;
  std::vector<Point> corners;
};

struct PolygonSyntax {
  std::string_view property;                // begins each error
  std::string_view example;                 // ends it
  std::span<const std::string_view> words;  // one of two begins each polygon; empty: none does
  bool world = false;                       // the word `world` may stand before the corners
};

// Returns an empty string and the polygons of the text; or what is wrong (naming the offending word and what to write
// instead), and leaves `polygons` as it was.
std::string parse_polygons(std::string_view text, const PolygonSyntax& syntax,
                           std::vector<TypedPolygon>& polygons);

}  // namespace cerberus::vision
