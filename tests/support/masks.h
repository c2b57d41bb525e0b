// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::tests {

// A mask in text: '#' is set. Rows have equal lengths.
inline vision::Image<std::uint8_t> drawn(const std::vector<std::string>& rows) {
  vision::Image<std::uint8_t> mask({static_cast<int>(rows[0].size()), static_cast<int>(rows.size())});
  for (std::size_t y = 0; y < rows.size(); ++y)
    for (std::size_t x = 0; x < rows[y].size(); ++x)
      mask.view().at(static_cast<int>(x), static_cast<int>(y)) = rows[y][x] == '#' ? 255 : 0;
  return mask;
}

inline vision::Image<std::uint8_t> random_mask(vision::Size size, unsigned percent, std::mt19937& random) {
  vision::Image<std::uint8_t> mask(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) mask.view().at(x, y) = random() % 100 < percent ? 255 : 0;
  return mask;
}

// Number of set pixels.
inline long count(vision::BitView bits) {
  long total = 0;
  for (int y = 0; y < bits.height; ++y)
    for (int x = 0; x < bits.width; ++x) total += std::popcount(bits.row(y)[x]);
  return total;
}

inline vision::BitMask packed(vision::GrayView mask) {
  vision::BitMask bits(bit_mask_size(mask.size()));
  pack(mask, bits.view());
  return bits;
}

}  // namespace cerberus::tests
