// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/picture.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

namespace cerberus::overlay {

Area Area::intersection(const Area& other) const {
  const int left = std::max(x, other.x), top = std::max(y, other.y);
  return {left, top, std::min(x + width, other.x + other.width) - left,
          std::min(y + height, other.y + other.height) - top};
}

Area Area::even() const {
  const int left = x & ~1, top = y & ~1;
  return {left, top, ((x + width + 1) & ~1) - left, ((y + height + 1) & ~1) - top};
}

Area Area::around(double left, double top, double right, double bottom, double margin) {
  const int x = static_cast<int>(std::floor(left - margin)), y = static_cast<int>(std::floor(top - margin));
  return {x, y, static_cast<int>(std::ceil(right + margin)) - x,
          static_cast<int>(std::ceil(bottom + margin)) - y};
}

PicturePtr PicturePool::take(int width, int height) {
  PicturePtr picture = take_unwritten(width, height);
  std::fill(picture->words.begin(), picture->words.end(), 0u);
  return picture;
}

PicturePtr PicturePool::take_unwritten(int width, int height) {
  const std::size_t words = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  const auto order = static_cast<std::size_t>(std::bit_width(std::max<std::size_t>(words, 1) - 1));
  if (classes_.size() <= order) classes_.resize(order + 1);
  Class& own = classes_[order];
  PicturePtr found;
  for (std::size_t i = 0; i < own.pictures.size() && !found; ++i) {
    own.next = own.next + 1 < own.pictures.size() ? own.next + 1 : 0;
    if (own.pictures[own.next].use_count() == 1) found = own.pictures[own.next];
  }
  if (found) {
    // Orders reads of the picture by the thread that released it before the writes that follow.
    std::atomic_thread_fence(std::memory_order_acquire);
  } else {
    found = std::make_shared<Picture>();
    found->words.reserve(std::size_t{1} << order);
    own.pictures.push_back(found);
  }
  found->width = width;
  found->height = height;
  found->words.resize(words);
  return found;
}

}  // namespace cerberus::overlay
