// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/blur.h"

#include <algorithm>
#include <cstring>

namespace cerberus::vision {

namespace {

constexpr int kChunk = 512;  // columns at a time, so that the sums stay on the stack and in the first cache

// (n + 4) / 9 without a division; exact for n <= 9 * 255.
inline std::uint8_t ninth(unsigned n) {
  return static_cast<std::uint8_t>(((n + 4) * 7282u) >> 16);
}

}  // namespace

void blur3(GrayView picture, int side, MutableGrayView out) {
  const int w = picture.width, h = picture.height;
  if (side < 3) {
    for (int y = 0; y < h; ++y) std::memcpy(out.row(y), picture.row(y), static_cast<std::size_t>(w));
    return;
  }
  std::uint16_t sums[kChunk + 2];  // column sums of the three rows, one column of margin on either side
  for (int y = 0; y < h; ++y) {
    const std::uint8_t* a = picture.row(std::max(y - 1, 0));
    const std::uint8_t* b = picture.row(y);
    const std::uint8_t* c = picture.row(std::min(y + 1, h - 1));
    std::uint8_t* o = out.row(y);
    const auto column = [&](int x) { return static_cast<std::uint16_t>(a[x] + b[x] + c[x]); };
    for (int begin = 0; begin < w; begin += kChunk) {
      const int count = std::min(kChunk, w - begin);
      for (int x = 0; x < count; ++x)
        sums[x + 1] = static_cast<std::uint16_t>(a[begin + x] + b[begin + x] + c[begin + x]);
      sums[0] = column(std::max(begin - 1, 0));
      sums[count + 1] = column(std::min(begin + count, w - 1));
      for (int x = 0; x < count; ++x) {
        const auto n = static_cast<std::uint16_t>(sums[x] + sums[x + 1] + sums[x + 2] + 4);
        o[begin + x] = static_cast<std::uint8_t>((n * 7282u) >> 16);
      }
    }
  }
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
