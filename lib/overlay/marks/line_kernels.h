// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loops of drawing lines from the distance of each pixel's centre, with the vectors of the processor at hand.
// A pixel's coverage is its distance inside the edge + 1/2, within 0 and 1.
#pragma once

#include <cstddef>
#include <cstdint>

#include "overlay/color.h"

namespace cerberus::overlay {

enum class LineStyle { solid, dashed, dotted };

// A line with a black casing below it.
struct CasedLine {
  LineStyle style = LineStyle::solid;
  float radius = 0;            // of the corners
  float half = 0, casing = 0;  // half widths of line and casing; the casing is wider
  float on = 0, period = 0;    // of dashes and dots
  Premultiplied color;         // of the line
  float casing_opacity = 0;
};

// The quarter of a rounded rectangle around one of its corners, split at the middles of the sides.
struct Quarter {
  float x = 0, y = 0;                  // centre of the corner's arc
  float outward_x = 1, outward_y = 1;  // direction from there to the corner: 1 or -1
  // Distance along the line, clockwise: at the end of the arc on the level side, counted on the arc and on the upright
  // side, and counted on the level side (both differ where the count begins).
  float walked = 0, walked_level = 0;
  float direction = 1;  // 1 where the distance grows from the level to the upright side, else -1
};

// Draws the pixels (x, y) to (x + pixels - 1, y) of the quarter. The radius must exceed the casing by half a pixel: the
// inside of the rectangle is then transparent.
void draw_quarter_row(const CasedLine& line, const Quarter& quarter, int x, int y, int pixels,
                      std::uint32_t* to);

// The depth of pixels inside a line of many stretches, and the strength of the deepest stretch; rows of `stride` floats,
// a multiple of kLineAlignment.
inline constexpr std::ptrdiff_t kLineAlignment = 16;
struct DepthMap {
  float* depth = nullptr;
  float* strength = nullptr;
  std::ptrdiff_t stride = 0;
};

// A stretch with round ends, in pixels of the map.
struct Stretch {
  float x = 0, y = 0, dx = 0, dy = 0;  // its begin; from there to its end
  float half = 0;                      // of its width
  float strength = 0;
};

// Enters the stretch in columns left..right - 1, at least, of rows top..bottom - 1 where it is deeper than what is there.
void measure_stretch(const Stretch& stretch, const DepthMap& map, int left, int right, int top, int bottom);

// The colours of a line that fades: `color` is the line's at strength 1, `casing` the opacity of its black casing, which
// is `casing_width` wide.
struct FadingLine {
  Premultiplied color;
  float casing = 0, casing_width = 0;
};

// Draws all pixels of a map of width x height.
void draw_depth(const FadingLine& line, const DepthMap& map, int width, int height, std::uint32_t* words);

}  // namespace cerberus::overlay
