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
  for_runs(c, self, runs, [&](const Run& run) {
    ++columns_[run.first - c.left];
    --columns_[run.end - c.left];
  });
  int highest = columns_[0];
  for (int x = 1; x < width; ++x) highest = std::max(highest, columns_[x] += columns_[x - 1]);
  int left = 0, right = width;
  while (columns_[left] < parameters_.skirt * highest) ++left;
  while (columns_[right - 1] < parameters_.skirt * highest) --right;
  return {c.left + left, c.top, c.left + right, c.bottom};
}

// A leg in stride rises from the foot to the knee beside the body, where a shadow lies flat. Returns the number of columns
// that it takes from `first` on, one `step` (1 or -1) after the other and `most` at most; 0: there is none.
int OutlineFinder::leg(const Component& c, int first, int step, int most, BitView moving) const {
  const Parameters& q = parameters_;
  const double h = c.height();
  const int least = static_cast<int>(q.thickness * h);
  if (least < q.least_leg) return 0;
  const int zone = c.bottom - static_cast<int>(q.shadow_zone * h);
  int knee = c.bottom, lowest = 0, fallen = 0;  // rows; columns up to where it last fell
  for (int k = 0; k < most && k - fallen <= q.toes * h; ++k) {
    const int x = first + step * k;
    int top = c.bottom, filled = 0;
    for (int y = c.bottom; y-- > zone;)
      if (bit_at(moving.row(y), x)) top = y, ++filled;
    if (filled < least) break;
    if (k == 0) knee = top;
    if (top > lowest) lowest = top, fallen = k + 1;
  }
  return c.bottom - knee >= q.knee * h && lowest - knee >= q.slope * fallen ? fallen : 0;
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
  whole.left = std::min(whole.left, body.left - leg(c, body.left - 1, -1, body.left - from, moving));
  whole.right = std::max(whole.right, body.right + leg(c, body.right, 1, to - body.right, moving));
  return whole;
}

Outline OutlineFinder::outline(const Component& component, std::size_t self, std::span<const Run> runs,
                               BitView moving) {
  const Bounds body = find_body(component, self, runs);
  return {body, add_limbs(component, body, moving)};
}

}  // namespace cerberus::vision
