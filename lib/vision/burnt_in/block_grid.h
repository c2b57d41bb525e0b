// SPDX-License-Identifier: LGPL-2.1-or-later
// The blocks in which burnt-in content is looked for: 8 x 4 pixels, of which the even rows are sampled.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "vision/image/image.h"

namespace cerberus::vision {

// A row of blocks is padded to whole words of a bit mask: one word holds a sampled row of eight blocks, and one 64-bit
// number holds their eight counts.
struct BlockGrid {
  static constexpr int kWidth = 8, kHeight = 4;  // pixels of a block
  static constexpr int kWord = 64 / kWidth;      // blocks of a word
  static constexpr int kStep = 2;                // every second row of the picture is sampled

  Size size;                             // of the picture, pixels
  int columns = 0, rows = 0, words = 0;  // blocks in the picture; words of one row of the picture

  BlockGrid() = default;
  explicit BlockGrid(Size picture)
      : size(picture),
        columns((picture.width + kWidth - 1) / kWidth),
        rows((picture.height + kHeight - 1) / kHeight),
        words((picture.width + 63) / 64) {}
  std::size_t stride() const { return static_cast<std::size_t>(words) * kWord; }
  std::size_t count() const { return stride() * static_cast<std::size_t>(rows); }
  std::size_t at(int x, int y) const { return static_cast<std::size_t>(y) * stride() + x; }
};

// 1 in each byte that is not 0, else 0.
inline std::uint64_t bytes_above_zero(std::uint64_t bytes) {
  constexpr std::uint64_t kOnes = 0x0101010101010101u;
  return (((bytes & 127 * kOnes) + 127 * kOnes) | bytes) >> 7 & kOnes;
}

inline std::uint64_t load_counts(const std::uint8_t* counts) {
  std::uint64_t value;
  std::memcpy(&value, counts, sizeof value);
  return value;
}
inline void store_counts(std::uint64_t value, std::uint8_t* counts) {
  std::memcpy(counts, &value, sizeof value);
}

// of[i] := 1 for the blocks of a row of which a sampled pixel exceeds `limit`, else 0. bits: scratch for two rows of words.
// Returns their number.
int find_blocks(GrayView picture, int limit, const BlockGrid& grid, int row, std::span<std::uint64_t> bits,
                std::uint8_t* of);

}  // namespace cerberus::vision
