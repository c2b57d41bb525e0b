// SPDX-License-Identifier: LGPL-2.1-or-later
// Blocks of a picture that are covered, filled with a colour or with large squares of their own means, in pictures of any
// layout of bytes or of words of 16 bits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "overlay/blend.h"
#include "overlay/color.h"
#include "vision/image/image.h"

namespace cerberus::overlay {

struct BlockMask {
  static constexpr int kBlock = 8;  // pixels; a multiple of every subsampling of chroma

  vision::Size frame;
  int columns = 0, rows = 0;
  std::vector<std::uint8_t> covered;  // of a block: 0 or 1

  // Nothing is covered.
  void reset(vision::Size size);
  bool any() const;
  std::uint8_t& at(int column, int row) { return covered[static_cast<std::size_t>(row) * columns + column]; }
  bool at(int column, int row) const {
    return covered[static_cast<std::size_t>(row) * columns + column] != 0;
  }
};

// Writes the colour into every sample of a covered block.
void fill(const BlockMask& mask, Color color, std::span<const BlendComponent> picture);

// Writes into every sample of a covered block the mean over its square of blocks: the picture has `squares` of them over
// its height, at least one.
void pixelate(const BlockMask& mask, int squares, std::span<const BlendComponent> picture);

}  // namespace cerberus::overlay
