// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/labelling.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace cerberus::vision {
namespace {

constexpr std::uint64_t kOnes = 0x0101010101010101ULL;
constexpr std::uint64_t kHighs = 0x8080808080808080ULL;

std::uint64_t load8(const std::uint8_t* p) {
  std::uint64_t v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

// Both searches look at eight pixels a step; the lowest byte that answers is the first pixel only on
// little-endian machines, the others take the plain loop below.
int find_moving(const std::uint8_t* row, int x, int width) {
  if constexpr (std::endian::native == std::endian::little) {
    for (; x + 8 <= width; x += 8)
      if (const std::uint64_t v = load8(row + x)) return x + std::countr_zero(v) / 8;
  }
  while (x < width && row[x] == 0) ++x;
  return x;
}

int find_still(const std::uint8_t* row, int x, int width) {
  if constexpr (std::endian::native == std::endian::little) {
    for (; x + 8 <= width; x += 8) {
      const std::uint64_t v = load8(row + x);
      // Marks zero bytes; marks above the lowest one may be wrong (borrow), the lowest never is.
      if (const std::uint64_t zero = (v - kOnes) & ~v & kHighs) return x + std::countr_zero(zero) / 8;
    }
  }
  while (x < width && row[x] != 0) ++x;
  return x;
}

}  // namespace

std::uint32_t Labeller::root(std::uint32_t i) {
  while (parent_[i] != i) {
    parent_[i] = parent_[parent_[i]];  // path halving
    i = parent_[i];
  }
  return i;
}

void Labeller::cut_row(const std::uint8_t* row, int width, int y) {
  for (int x = find_moving(row, 0, width); x < width; x = find_moving(row, x, width)) {
    const int end = find_still(row, x + 1, width);
    parent_.push_back(static_cast<std::uint32_t>(runs_.size()));
    runs_.push_back({y, x, end, 0});
    x = end;
  }
}

// Runs [above, here) are the row above, [here, end) this one; both sorted by column. Touching, diagonals
// included, means first <= other.end and other.first <= end (ends are exclusive).
void Labeller::join_rows(std::size_t above, std::size_t here, std::size_t end) {
  std::size_t a = above;
  for (std::size_t b = here; b < end; ++b) {
    while (a < here && runs_[a].end < runs_[b].first) ++a;
    for (std::size_t i = a; i < here && runs_[i].first <= runs_[b].end; ++i) {
      const std::uint32_t p = root(static_cast<std::uint32_t>(i));
      const std::uint32_t q = root(static_cast<std::uint32_t>(b));
      parent_[std::max(p, q)] = std::min(p, q);
    }
  }
}

std::span<const Component> Labeller::find(GrayView mask) {
  runs_.clear();
  parent_.clear();
  components_.clear();
  std::size_t above = 0;
  for (int y = 0; y < mask.height; ++y) {
    const std::size_t here = runs_.size();
    cut_row(mask.row(y), mask.width, y);
    join_rows(above, here, runs_.size());
    above = here;
  }
  // A root is its component's first run, so it is met before the others and numbers are given in reading
  // order.
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    Run& run = runs_[i];
    const std::uint32_t r = root(static_cast<std::uint32_t>(i));
    if (r == i) {
      run.component = static_cast<std::uint32_t>(components_.size());
      components_.push_back({run.first, run.row, run.end, run.row + 1, 0, 0, 0});
    } else {
      run.component = runs_[r].component;
    }
    Component& c = components_[run.component];
    const auto length = static_cast<std::uint32_t>(run.end - run.first);
    c.left = std::min(c.left, run.first);
    c.right = std::max(c.right, run.end);
    c.bottom = run.row + 1;
    c.area += length;
    // Sum of first .. end-1; the product is even because the factors' parities differ or both are even.
    c.sum_x += static_cast<std::uint64_t>(run.first + run.end - 1) * length / 2;
    c.sum_y += static_cast<std::uint64_t>(run.row) * length;
  }
  return components_;
}

std::span<const Component> Labeller::drop_smaller(std::uint32_t least, MutableGrayView mask) {
  constexpr std::uint32_t gone = ~0u;
  std::vector<std::uint32_t>& renumbered =
      parent_;  // the forest has served; at least as many runs as components
  std::uint32_t kept = 0;
  for (std::size_t i = 0; i < components_.size(); ++i) {
    const bool keep = components_[i].area >= least;
    renumbered[i] = keep ? kept : gone;
    if (keep) components_[kept++] = components_[i];
  }
  components_.resize(kept);
  std::size_t end = 0;
  for (Run run : runs_) {
    run.component = renumbered[run.component];
    if (run.component == gone)
      std::fill(mask.row(run.row) + run.first, mask.row(run.row) + run.end, std::uint8_t{0});
    else
      runs_[end++] = run;
  }
  runs_.resize(end);
  return components_;
}

void Labeller::write(View<std::uint16_t> labels) const {
  for (int y = 0; y < labels.height; ++y)
    std::memset(labels.row(y), 0, static_cast<std::size_t>(labels.width) * sizeof(std::uint16_t));
  for (const Run& run : runs_) {
    const auto label = static_cast<std::uint16_t>(std::min<std::uint32_t>(run.component + 1, 65535));
    std::fill(labels.row(run.row) + run.first, labels.row(run.row) + run.end, label);
  }
}

std::size_t Labeller::bytes() const {
  return runs_.capacity() * sizeof(Run) + parent_.capacity() * sizeof(std::uint32_t) +
         components_.capacity() * sizeof(Component);
}

}  // namespace cerberus::vision
