// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture at full, half, quarter ... size.
#pragma once

#include <array>

#include "vision/image/image.h"

namespace cerberus::vision {

// Level 0 is the picture; every further one is half as wide and high (odd last columns and rows are left out), each
// pixel the rounded mean of four. A point x of level 0 lies at (x + 0.5) / 2^l - 0.5 of level l.
class Pyramid {
 public:
  static constexpr int kMaxLevels = 8;

  // Level 0 refers to the picture itself, which must stay valid and unchanged for as long as the pyramid is used.
  // `levels` at most kMaxLevels; stops earlier at an empty level. Allocates only when the size changes.
  void borrow(GrayView picture, int levels);
  // Adds levels of the same picture.
  void extend(int levels);
  // Takes the levels of `other` from level 1 on, with the size but not the pixels of its level 0. `other` must
  // borrow again before its next use.
  void take(Pyramid& other);
  int levels() const { return levels_; }
  GrayView level(int l) const { return l > 0 ? smaller_[l - 1].view() : picture_; }
  Size size() const { return levels_ ? picture_.size() : Size{}; }
  std::size_t bytes() const;

 private:
  GrayView picture_;
  std::array<Image<std::uint8_t>, kMaxLevels - 1> smaller_;  // from level 1 on
  int levels_ = 0;
};

}  // namespace cerberus::vision
