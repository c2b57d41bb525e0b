// SPDX-License-Identifier: LGPL-2.1-or-later
// A small picture of a whole scene in which the place of a window is marked.
#pragma once

#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::overlay {

// A rectangle in corner coordinates: the pixel (i, j) covers [i, i + 1) x [j, j + 1).
struct InsetPlace {
  double left = 0, top = 0, right = 0, bottom = 0;
};

// Returns the size, in pixels, of the picture of a scene in the corner of a frame: with the scene's aspect, within 0.3
// of the frame's width and 0.4 of its height. Returns {0, 0} if it would be too small to be recognised (less than 24
// pixels wide or 16 high).
vision::Size inset_size(vision::Size scene, vision::Size frame);

// Dims the picture outside `place` and draws a white line, `line` pixels wide, around the place. Samples are words of
// alpha, red, green, blue from the highest byte down; alpha becomes 255. With a = the share of a pixel in the place,
// and b = the share in the place enlarged by the line on all sides, a colour becomes
//   c (a + (1 - b) kInsetDimming) + 255 (b - a)
// so that the rectangle can move by less than a pixel.
inline constexpr double kInsetDimming = 0.65;
void mark_place(vision::View<std::uint32_t> picture, const InsetPlace& place, double line);

}  // namespace cerberus::overlay
