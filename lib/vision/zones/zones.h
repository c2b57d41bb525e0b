// SPDX-License-Identifier: LGPL-2.1-or-later
// Where motion counts: polygons that a user types, in fractions of the picture or in degrees of the world.
//
//   zones="include 0.1,0.1 0.9,0.1 0.9,0.9; exclude world -12,4 -5,4 -5,-6 -12,-6"
//
// Polygons are parted by `;` (or a line break); each is the word include or exclude and at least three
// corners parted by blanks: x,y to the right and downwards, 0 to 1, or, after the word world, pan,tilt in degrees, to the
// right and up. Decimal points, whatever the locale.
// A pixel counts when it lies in some include polygon (everywhere if there is none) and in no exclude
// polygon, whatever the order. A polygon that crosses itself is filled even-odd. Where the camera's orientation is not
// known, polygons of the world hide nothing: one that includes includes everything, one that excludes excludes nothing.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "vision/geometry/camera_orientation.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"
#include "vision/zones/world_polygon.h"

namespace cerberus::vision {

class Zones {
 public:
  // Replaces the polygons. Returns an empty string, or what is wrong (naming the offending word and what to
  // write instead) and keeps the polygons it had. An empty text means: everywhere.
  std::string parse(std::string_view text);

  bool everywhere() const { return polygons_.empty(); }
  // Some polygon is of the world.
  bool need_orientation() const { return in_world_; }

  // The camera of one frame, in pixels of a frame of size `frame`.
  struct View {
    CameraOrientation camera;
    Size frame;
  };

  // mask := 0 where motion does not count. The polygons are drawn once for each picture size and view.
  void apply(MutableGrayView mask, const std::optional<View>& view = {});

  // The polygons left no pixel of the last mask, and cannot leave one in another view.
  bool nowhere() const { return !everywhere() && !in_world_ && nowhere_; }

  // 255 where motion counts, drawn afresh; a pixel belongs to a polygon when its centre does.
  void draw(MutableGrayView plane, const std::optional<View>& view = {}) const;

  // Returns whether a point counts. at: fractions of the picture; direction: where it lies in the world, if that is
  // known.
  bool contain(Point at, const std::optional<Direction>& direction) const;
  // The same of a point in pixels of a frame. camera: with a lens that is not known, or none: its direction is not known.
  bool contain(Point pixel, Size frame, const std::optional<CameraOrientation>& camera) const;

 private:
  struct Polygon {
    bool include = true;
    std::vector<Point> corners;         // fractions of the picture
    std::optional<WorldPolygon> world;  // instead of them
  };
  bool changed(const std::optional<View>& view);

  std::vector<Polygon> polygons_;
  bool in_world_ = false;
  Image<std::uint8_t> plane_;
  std::optional<View> view_;  // that plane_ was drawn for
  bool drawn_ = false, nowhere_ = false;
};

}  // namespace cerberus::vision
