// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/pyramid.h"

#include <algorithm>
#include <utility>

#include "vision/image/filter_kernels.h"

namespace cerberus::vision {

void Pyramid::borrow(GrayView picture, int levels) {
  picture_ = picture;
  levels_ = 1;
  extend(levels);
}

void Pyramid::take(Pyramid& other) {
  picture_ = {nullptr, other.picture_.width, other.picture_.height, 0};
  for (std::size_t i = 0; i < smaller_.size(); ++i) smaller_[i].swap(other.smaller_[i]);
  levels_ = std::exchange(other.levels_, 0);
}

void Pyramid::extend(int levels) {
  for (; levels_ < std::min(levels, kMaxLevels); ++levels_) {
    const GrayView from = level(levels_ - 1);
    const Size half{from.width / 2, from.height / 2};
    if (half.width == 0 || half.height == 0) break;
    Image<std::uint8_t>& image = smaller_[levels_ - 1];
    image.resize(half);
    const MutableGrayView to = image.view();
    for (int y = 0; y < half.height; ++y)
      halve_rows(from.row(2 * y), from.row(2 * y + 1), half.width, to.row(y));
  }
}

std::size_t Pyramid::bytes() const {
  std::size_t total = 0;
  for (const auto& image : smaller_) total += image.bytes();
  return total;
}

}  // namespace cerberus::vision
