// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/pyramid.h"

#include <algorithm>

#include "vision/motion_kernels.h"

namespace cerberus::vision {

void Pyramid::build(GrayView picture, int levels) {
  images_[0].resize(picture.size());
  for (int y = 0; y < picture.height; ++y)
    std::memcpy(images_[0].view().row(y), picture.row(y), static_cast<std::size_t>(picture.width));
  levels_ = 1;
  extend(levels);
}

void Pyramid::extend(int levels) {
  for (; levels_ < std::min(levels, kMaxLevels); ++levels_) {
    const GrayView from = images_[levels_ - 1].view();
    const Size half{from.width / 2, from.height / 2};
    if (half.width == 0 || half.height == 0) break;
    images_[levels_].resize(half);
    const MutableGrayView to = images_[levels_].view();
    for (int y = 0; y < half.height; ++y)
      halve_rows(from.row(2 * y), from.row(2 * y + 1), half.width, to.row(y));
  }
}

std::size_t Pyramid::bytes() const {
  std::size_t total = 0;
  for (const auto& image : images_) total += image.bytes();
  return total;
}

}  // namespace cerberus::vision
