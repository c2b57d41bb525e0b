// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/blur.h"

#include <algorithm>
#include <cstring>

#include "vision/image/filter_kernels.h"

namespace cerberus::vision {

void blur3(GrayView picture, int side, MutableGrayView out) {
  const int w = picture.width, h = picture.height;
  if (side < 3) {
    for (int y = 0; y < h; ++y) std::memcpy(out.row(y), picture.row(y), static_cast<std::size_t>(w));
    return;
  }
  for (int y = 0; y < h; ++y)
    blur3_row(picture.row(std::max(y - 1, 0)), picture.row(y), picture.row(std::min(y + 1, h - 1)), w,
              out.row(y));
}

void blur3_reference(GrayView picture, MutableGrayView out) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      int sum = 0;
      for (int v = -1; v <= 1; ++v)
        for (int u = -1; u <= 1; ++u)
          sum +=
              picture.at(std::clamp(x + u, 0, picture.width - 1), std::clamp(y + v, 0, picture.height - 1));
      out.at(x, y) = static_cast<std::uint8_t>((2 * sum + 9) / 18);
    }
}

}  // namespace cerberus::vision
