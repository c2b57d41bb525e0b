// SPDX-License-Identifier: LGPL-2.1-or-later
// A small picture of a whole scene, with the place in it at which a window looks.
#pragma once

#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::overlay {

// A rectangle in corner coordinates: the pixel (i, j) covers [i, i + 1) x [j, j + 1).
struct InsetPlace {
  double left = 0, top = 0, right = 0, bottom = 0;
};

// How large the picture of a scene is that stands in the corner of a frame: the scene's shape, within 0.3 of the
// frame's width and 0.4 of its height. {0, 0} where nobody could make anything of it (less than 24 pixels wide or 16
// high).
vision::Size inset_size(vision::Size scene, vision::Size frame);

// Outside `place` the picture is dimmed, inside it is as it was, and round it runs a white line, `line` pixels wide.
// Samples are words of alpha, red, green, blue from the highest byte down; alpha becomes 255. With a = the share of a
// pixel that lies in the place, and b = the share that lies in the place grown by the line to all sides, a colour
// becomes
//   c (a + (1 - b) kInsetDimming) + 255 (b - a)
// so that the rectangle moves by less than a pixel, too.
inline constexpr double kInsetDimming = 0.65;
void mark_place(vision::View<std::uint32_t> picture, const InsetPlace& place, double line);

}  // namespace cerberus::overlay
