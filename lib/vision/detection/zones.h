// SPDX-License-Identifier: LGPL-2.1-or-later
// Where motion counts: polygons that a user types, in fractions of the picture.
//
//   zones="include 0.1,0.1 0.9,0.1 0.9,0.9; exclude 0.4,0 0.6,0 0.6,0.3 0.4,0.3"
//
// Polygons are parted by `;` (or a line break); each is the word include or exclude and at least three
// corners x,y parted by blanks, x to the right and y downwards, 0 to 1. Decimal points, whatever the locale.
// A pixel counts when it lies in some include polygon (everywhere if there is none) and in no exclude
// polygon, whatever the order. A polygon that crosses itself is filled even-odd.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

class Zones {
 public:
  // Replaces the polygons. Returns an empty string, or what is wrong (naming the offending word and what to
  // write instead) and keeps the polygons it had. An empty text means: everywhere.
  std::string parse(std::string_view text);

  bool everywhere() const { return polygons_.empty(); }

  // mask := 0 where motion does not count. The polygons are drawn once for each picture size.
  void apply(MutableGrayView mask);

  // The polygons left no pixel of the last mask.
  bool nowhere() const { return !everywhere() && nowhere_; }

  // 255 where motion counts, drawn afresh; a pixel belongs to a polygon when its centre does.
  void draw(MutableGrayView plane) const;

 private:
  struct Polygon {
    bool include = true;
    std::vector<Point> corners;
  };
  std::vector<Polygon> polygons_;
  Image<std::uint8_t> plane_;
  bool drawn_ = false, nowhere_ = false;
};

}  // namespace cerberus::vision
