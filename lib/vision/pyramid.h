// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture at full, half, quarter ... size.
#pragma once

#include <array>

#include "vision/image.h"

namespace cerberus::vision {

// Level 0 is a copy of the picture; every further one is half as wide and high (odd last columns and rows are left
// out), each pixel the rounded mean of four. A point x of level 0 lies at (x + 0.5) / 2^l - 0.5 of level l.
class Pyramid {
 public:
  static constexpr int kMaxLevels = 8;

  // Allocates only when the size changes. `levels` at most kMaxLevels; stops earlier at an empty level.
  void build(GrayView picture, int levels);
  // More levels of the same picture.
  void extend(int levels);
  int levels() const { return levels_; }
  GrayView level(int l) const { return images_[l].view(); }
  Size size() const { return levels_ ? images_[0].size() : Size{}; }
  void swap(Pyramid& other) noexcept {
    images_.swap(other.images_);
    std::swap(levels_, other.levels_);
  }
  std::size_t bytes() const;

 private:
  std::array<Image<std::uint8_t>, kMaxLevels> images_;
  int levels_ = 0;
};

}  // namespace cerberus::vision
