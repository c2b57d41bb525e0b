// SPDX-License-Identifier: LGPL-2.1-or-later
// What is learnt as burnt-in content of the picture.
#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <span>
#include <string>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// Analysis pixels.
struct BurntInBoxes {
  static constexpr std::size_t kMost = 8;
  std::array<Box, kMost> box;
  std::size_t count = 0;
  std::bitset<kMost> is_new;  // found, grown to its size, and not overlapping one that was new before

  std::span<const Box> boxes() const { return {box.data(), count}; }
};

// The new boxes for a message, as "width x height + left + top" in frame pixels; empty: none is new.
std::string new_boxes(const BurntInBoxes& found, Size analysis, Size frame);

// Clears boxes (whole pixels, within the picture) in a mask, but for the columns whose pixels above and below a box are
// foreground: what is foreground there is so behind the writing, too.
void clear_boxes(std::span<const Box> boxes, MutableGrayView mask);

}  // namespace cerberus::vision
