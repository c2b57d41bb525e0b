// SPDX-License-Identifier: LGPL-2.1-or-later
// People drawn into a mask or a picture, so that the right boxes are known.
#pragma once

#include <algorithm>
#include <cmath>
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

inline void draw_ellipse(vision::MutableGrayView picture, double cx, double cy, double rx, double ry,
                         std::uint8_t value) {
  for (int y = std::max(0, static_cast<int>(cy - ry)); y <= std::min(picture.height - 1.0, cy + ry); ++y)
    for (int x = std::max(0, static_cast<int>(cx - rx)); x <= std::min(picture.width - 1.0, cx + rx); ++x)
      if (std::hypot((x - cx) / rx, (y - cy) / ry) < 1) picture.at(x, y) = value;
}
// A bar that leans, from row y0 to row y1.
inline void draw_bar(vision::MutableGrayView picture, double x0, double y0, double x1, double y1, double half,
                     std::uint8_t value) {
  for (int y = std::max(0, static_cast<int>(y0)); y < std::min(static_cast<double>(picture.height), y1);
       ++y) {
    const double cx = x0 + (x1 - x0) * (y - y0) / (y1 - y0);
    for (int x = std::max(0, static_cast<int>(cx - half)); x <= std::min(picture.width - 1.0, cx + half); ++x)
      if (std::abs(x - cx) < half) picture.at(x, y) = value;
  }
}

// A person who stands, with round shapes that a people detector finds; x, y: top left corner of the box, which is .4 as
// wide as high and is returned.
inline vision::Box draw_person(vision::MutableGrayView picture, double x, double y, double height,
                               std::uint8_t value) {
  const double s = height / 100, middle = x + 20 * s;
  draw_ellipse(picture, middle, y + 8 * s, 6.5 * s, 8 * s, value);
  draw_ellipse(picture, middle, y + 32 * s, 12.5 * s, 19 * s, value);
  draw_bar(picture, middle - 5 * s, y + 44 * s, middle - 8 * s, y + 99 * s, 5 * s, value);
  draw_bar(picture, middle + 5 * s, y + 44 * s, middle + 8 * s, y + 99 * s, 5 * s, value);
  return {x, y, 0.4 * height, height};
}

}  // namespace cerberus::tests
