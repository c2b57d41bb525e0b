// SPDX-License-Identifier: LGPL-2.1-or-later
// The line round a box: a rounded rectangle with a dark casing, solid, dashed or dotted, drawn from the distance of
// each pixel's centre to the line. A pixel's coverage is its distance inside the edge of the line + 1/2, within 0 and
// 1: exact along the sides, within a few percent in the corners. No path is built and nothing is allocated.
#pragma once

#include <cstdint>

#include "overlay/color.h"
#include "overlay/marks/line_kernels.h"
#include "overlay/picture.h"

namespace cerberus::overlay {

class Outline {
 public:
  // Corner coordinates of the box in the frame, pixels; `line`: width of the line. Dashes are about 5 lines long with
  // gaps of 4; dots are 1.3 lines wide and about 2.6 lines apart: a whole number of them fits round the box.
  Outline(double x, double y, double width, double height, double line, LineStyle style, Color color);

  // Returns the distance, in pixels, that the drawing extends from the box to the outside, and, beyond the rows and
  // columns next to the sides, to the inside: the corners are round.
  double reach() const { return reach_; }
  double inner_reach() const;
  // Draws the part in `area` (of the frame) into a picture of the area's size. All of its pixels are written.
  void draw(Area area, vision::View<std::uint32_t> picture) const;
  // The same, pixel by pixel: the definition, and for lines of which draw() cannot.
  void draw_exactly(Area area, vision::View<std::uint32_t> picture) const;

 private:
  struct Place {
    float distance = 0;  // from the line, positive outside
    float walked = 0;    // along the line, from the right end of its upper side clockwise
  };
  // A half of a row beside a side, and the last row of it without a gap in this picture.
  struct Side {
    Quarter quarter;
    const std::uint32_t* whole = nullptr;
  };
  Place place(float x, float y) const;
  std::uint32_t word(Place place) const;
  float along(float walked) const;
  Quarter quarter(bool lower, bool right) const;
  void draw_level(Area area, int y, std::uint32_t* row) const;
  void draw_upright(Side& side, int x, int y, int pixels, std::uint32_t* row) const;

  float left_, top_, right_, bottom_;
  float bend_, wide_, high_;  // lengths of a corner's arc and of the straight parts of the sides
  float reach_;
  CasedLine line_;
};

}  // namespace cerberus::overlay
