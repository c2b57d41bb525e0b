// SPDX-License-Identifier: LGPL-2.1-or-later
// The line round a box: a rounded rectangle with a dark casing, solid, dashed or dotted, drawn from the distance of
// each pixel's centre to the line. A pixel's coverage is its distance inside the edge of the line + 1/2, within 0 and
// 1: exact along the sides, within a few percent in the corners. No path is built and nothing is allocated.
#pragma once

#include <cstdint>

#include "overlay/color.h"
#include "overlay/picture.h"

namespace cerberus::overlay {

enum class LineStyle { solid, dashed, dotted };

class Outline {
 public:
  // Corner coordinates of the box in the frame, pixels; `line`: width of the line. Dashes are 5 lines long with gaps of
  // 4; dots are 1.3 lines wide and 2.6 lines apart.
  Outline(double x, double y, double width, double height, double line, LineStyle style, Color color);

  // Returns the distance, in pixels, that the drawing extends from the box to both sides of its line.
  double reach() const { return reach_; }
  // Radius of the corners.
  double corner() const { return radius_; }
  // Draws the part in `area` (of the frame) into a transparent picture of the area's size.
  void draw(Area area, vision::View<std::uint32_t> picture) const;

 private:
  struct Place {
    float distance = 0;  // from the line, positive outside
    float walked = 0;    // along the line, from the right end of its upper side clockwise
  };
  Place place(float x, float y) const;
  Premultiplied shade(float distance, float casing, float line) const;
  std::uint32_t word_at(float distance) const;
  std::uint32_t word(Place place) const;
  float along(float walked) const;
  void draw_exactly(Area area, vision::View<std::uint32_t> picture, Area part) const;
  void draw_run(Area area, vision::View<std::uint32_t> picture, Area part, bool upright) const;

  float left_, top_, right_, bottom_;
  float radius_, bend_;          // of the corners; length of a quarter circle
  float half_, casing_, reach_;  // half widths of line and casing
  float on_ = 0, period_ = 0;    // of dashes and dots
  LineStyle style_;
  Premultiplied line_color_, casing_color_;
  std::uint32_t line_word_ = 0, casing_word_ = 0;  // of pixels that are covered wholly
};

}  // namespace cerberus::overlay
