// SPDX-License-Identifier: LGPL-2.1-or-later
// Smooth random pictures whose place and size are known to a fraction of a pixel.
#pragma once

#include <cmath>
#include <cstdint>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::tests {

// Level at a point of an endless pattern, 40 to 216; it changes over some pixels.
inline double texture(double x, double y, int seed) {
  const double a = seed * 1.7, b = seed * 0.9;
  return 128 + 22 * (std::sin(x / 3.1 + a) + std::sin(y / 3.7 + b) + std::sin((x + y) / 5.3 + a * b) +
                     std::sin((x - 1.3 * y) / 4.1 + b));
}

// The pattern with its origin at x, y, enlarged about it.
inline void paint(vision::Image<std::uint8_t>& picture, const vision::Box& part, double x, double y, int seed,
                  double size = 1) {
  const auto view = picture.view();
  for (int row = 0; row < view.height; ++row)
    for (int column = 0; column < view.width; ++column)
      if (column >= part.x && column < part.right() && row >= part.y && row < part.bottom())
        view.at(column, row) =
            static_cast<std::uint8_t>(std::lround(texture((column - x) / size, (row - y) / size, seed)));
}

inline vision::Box all_of(vision::Size size) {
  return {0, 0, static_cast<double>(size.width), static_cast<double>(size.height)};
}

}  // namespace cerberus::tests
