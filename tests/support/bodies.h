// SPDX-License-Identifier: LGPL-2.1-or-later
// People drawn into a mask, so that the right boxes are known.
#pragma once

#include <algorithm>
#include <cstdint>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::tests {

// Whole pixels; what lies outside is left out.
inline void fill(vision::MutableGrayView mask, double left, double top, double right, double bottom,
                 std::uint8_t value = 255) {
  for (int y = std::max(0, static_cast<int>(top)); y < std::min(mask.height, static_cast<int>(bottom)); ++y)
    for (int x = std::max(0, static_cast<int>(left)); x < std::min(mask.width, static_cast<int>(right)); ++x)
      mask.at(x, y) = value;
}

// A head, a trunk and two legs with a gap between them. Returns the box.
inline vision::Box draw_body(vision::MutableGrayView mask, double middle, double foot, double height) {
  const double w = 0.36 * height, top = foot - height;
  fill(mask, middle - 0.2 * w, top, middle + 0.2 * w, top + 0.15 * height);
  fill(mask, middle - 0.5 * w, top + 0.15 * height, middle + 0.5 * w, top + 0.55 * height);
  fill(mask, middle - 0.4 * w, top + 0.55 * height, middle - 0.08 * w, foot);
  fill(mask, middle + 0.08 * w, top + 0.55 * height, middle + 0.4 * w, foot);
  return {middle - w / 2, top, w, height};
}

}  // namespace cerberus::tests
