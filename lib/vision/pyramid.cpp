// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/pyramid.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "vision/motion_kernels.h"

namespace cerberus::vision {

void Pyramid::copy(GrayView picture) {
  images_[0].resize(picture.size());
  picture_ = images_[0].view();
  for (int y = 0; y < picture.height; ++y)
    std::memcpy(images_[0].view().row(y), picture.row(y), static_cast<std::size_t>(picture.width));
}

void Pyramid::build(GrayView picture, int levels) {
  copy(picture);
  levels_ = 1;
  extend(levels);
}

void Pyramid::borrow(GrayView picture, int levels) {
  picture_ = picture;
  levels_ = 1;
  extend(levels);
}

void Pyramid::take(Pyramid& other) {
  images_[0] = {};
  picture_ = {nullptr, other.picture_.width, other.picture_.height, 0};
  for (std::size_t l = 1; l < images_.size(); ++l) images_[l].swap(other.images_[l]);
  levels_ = std::exchange(other.levels_, 0);
}

void Pyramid::extend(int levels) {
  for (; levels_ < std::min(levels, kMaxLevels); ++levels_) {
    const GrayView from = level(levels_ - 1);
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
