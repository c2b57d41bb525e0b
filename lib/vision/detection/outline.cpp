// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/outline.h"

#include <algorithm>

#include "vision/image/preallocate.h"

namespace cerberus::vision {

void OutlineFinder::preallocate(int width) {
  vision::preallocate(columns_, static_cast<std::size_t>(width) + 1);
}

std::size_t OutlineFinder::bytes() const {
  return bytes_of(columns_);
}

// A shadow on the floor is wide and low: the body ends where the columns become low.
Bounds OutlineFinder::find_body(const Component& c, std::size_t self, std::span<const Run> runs) {
  // Each run adds one to its columns: steps up and down first, summed up afterwards.
  const int width = c.width();
  columns_.assign(static_cast<std::size_t>(width) + 1, 0);
  auto run = std::ranges::lower_bound(runs, c.top, {}, &Run::row);
  for (; run != runs.end() && run->row < c.bottom; ++run) {
    if (run->component != self) continue;
    ++columns_[run->first - c.left];
    --columns_[run->end - c.left];
  }
  int highest = columns_[0];
  for (int x = 1; x < width; ++x) highest = std::max(highest, columns_[x] += columns_[x - 1]);
  int left = 0, right = width;
  while (columns_[left] < parameters_.skirt * highest) ++left;
  while (columns_[right - 1] < parameters_.skirt * highest) --right;
  return {c.left + left, c.top, c.left + right, c.bottom};
}

// An outstretched arm or leg makes low columns as a shadow does, but reaches higher. What only the closing has joined to
// the body is no limb.
Bounds OutlineFinder::add_limbs(const Component& c, const Bounds& body, BitView moving) {
  const Parameters& q = parameters_;
  const int reach = static_cast<int>(q.reach * c.height());
  const int from = std::max(c.left, body.left - reach), to = std::min(c.right, body.right + reach);
  if (from >= body.left && to <= body.right) return body;
  std::fill_n(columns_.begin(), to - from, 0);
  const int zone = c.bottom - static_cast<int>(q.shadow_zone * c.height());
  for (int y = c.top; y < zone; ++y) {
    const auto count = [&](int x) { ++columns_[x - from]; };
    for_bits(moving.row(y), from, body.left, count);
    for_bits(moving.row(y), body.right, to, count);
  }
  const int least = std::max(1, static_cast<int>(q.thickness * c.height()));
  Bounds whole = body;
  while (whole.left > from && columns_[whole.left - 1 - from] >= least) --whole.left;
  while (whole.right < to && columns_[whole.right - from] >= least) ++whole.right;
  return whole;
}

Outline OutlineFinder::outline(const Component& component, std::size_t self, std::span<const Run> runs,
                               BitView moving) {
  const Bounds body = find_body(component, self, runs);
  return {body, add_limbs(component, body, moving)};
}

}  // namespace cerberus::vision
