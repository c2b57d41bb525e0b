// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/burnt_in/block_grid.h"

#include <algorithm>
#include <bit>

#include "vision/image/mask_kernels.h"

namespace cerberus::vision {

int find_blocks(GrayView picture, int limit, const BlockGrid& grid, int row, std::span<std::uint64_t> bits,
                std::uint8_t* of) {
  const auto words = static_cast<std::size_t>(grid.words);
  for (std::size_t line = 0; line < 2; ++line) {
    const int y = row * BlockGrid::kHeight + static_cast<int>(line) * BlockGrid::kStep;
    std::uint64_t* to = bits.data() + line * words;
    if (y < picture.height)
      binarise_row(picture.row(y), picture.width, static_cast<std::uint8_t>(std::clamp(limit, 0, 255)), to);
    else
      std::fill_n(to, words, std::uint64_t{0});
  }
  int count = 0;
  for (std::size_t w = 0; w < words; ++w) {
    const std::uint64_t found = bytes_above_zero(bits[w] | bits[words + w]);
    store_counts(found, of + w * BlockGrid::kWord);
    count += std::popcount(found);
  }
  return count;
}

}  // namespace cerberus::vision
