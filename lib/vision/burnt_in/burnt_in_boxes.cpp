// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/burnt_in_boxes.h"

#include <cmath>
#include <cstdio>

namespace cerberus::vision {

std::string new_boxes(const BurntInBoxes& found, Size analysis, Size frame) {
  const double sx = static_cast<double>(frame.width) / analysis.width,
               sy = static_cast<double>(frame.height) / analysis.height;
  std::string text;
  for (std::size_t i = 0; i < found.count; ++i) {
    if (!found.is_new[i]) continue;
    const Box& b = found.box[i];
    char box[80];
    std::snprintf(box, sizeof box, "%s%ldx%ld+%ld+%ld", text.empty() ? "" : ", ", std::lround(b.width * sx),
                  std::lround(b.height * sy), std::lround(b.x * sx), std::lround(b.y * sy));
    text += box;
  }
  return text;
}

void clear_boxes(std::span<const Box> boxes, MutableGrayView mask) {
  for (const Box& b : boxes) {
    const int left = static_cast<int>(b.x), top = static_cast<int>(b.y);
    const int right = static_cast<int>(b.right()), bottom = static_cast<int>(b.bottom());
    const bool between = top > 0 && bottom < mask.height;
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        mask.at(x, y) = between ? mask.at(x, top - 1) & mask.at(x, bottom) : 0;
  }
}

}  // namespace cerberus::vision
