// SPDX-License-Identifier: LGPL-2.1-or-later
// Connected components of a mask with their boxes and areas, by runs.
//
// A row is cut into runs of moving pixels; a run joins every run of the row above that it touches
// (8-connected) in a union-find forest whose root is always the earliest run, so that labels come out in
// reading order of the components' first pixels whatever the shape (L. He, Y. Chao, K. Suzuki, "A run-based
// two-scan labeling algorithm", IEEE Trans. Image Processing 17(5), 2008, is the idea). Areas are sums over
// runs, not over pixels.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

struct Component {
  int left = 0, top = 0;      // first column and row
  int right = 0, bottom = 0;  // one past the last column and row
  std::uint32_t area = 0;     // pixels

  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

// How far two extents (columns or rows) lie apart; below 0 where they overlap.
constexpr int gap(int a_from, int a_to, int b_from, int b_to) {
  return (a_from > b_from ? a_from : b_from) - (a_to < b_to ? a_to : b_to);
}

// Whether two components lie less than so many pixels apart, across and down.
constexpr bool are_within(double pixels, const Component& a, const Component& b) {
  return gap(a.left, a.right, b.left, b.right) < pixels && gap(a.top, a.bottom, b.top, b.bottom) < pixels;
}

// One horizontal stretch of moving pixels. 16 bits: no picture here is wider or higher than 65535.
struct Run {
  std::uint16_t row = 0;
  std::uint16_t first = 0, end = 0;  // columns, end is one past the last
  std::uint16_t component = 0;       // index into components()
};

class Labeller {
 public:
  // What there is room for; at most 65535 of each.
  struct Limits {
    std::size_t runs = 0, components = 0;
  };
  // By the picture's size: several times what the busiest street gives.
  Labeller() = default;
  explicit Labeller(const Limits& limits) : fixed_(limits) {}

  // What find() does first: takes the memory for pictures of this size.
  void preallocate(Size picture);

  // Finds the components of the set bits (8-connected) that have at least `least` pixels; the others' bits are cleared.
  // Component i carries label i + 1. width: the picture's, pixels.
  // Memory is bounded and taken at the first picture of a size. What does not fit is clutter (rain, a failing sensor),
  // and loses its small parts until it fits: by openings with growing squares while there are too many runs, by
  // doubling `least` while there are too many components. The bits always show what was found. The spans live until the
  // next call.
  std::span<const Component> find(MutableBitView bits, int width, std::uint32_t least = 1);

  const Limits& limits() const { return limits_; }
  std::span<const Component> components() const { return components_; }
  // In reading order.
  std::span<const Run> runs() const { return runs_; }

  // labels := label of each pixel, 0 where nothing moves. Size as the mask's.
  void write(View<std::uint16_t> labels) const;

  std::size_t bytes() const;

 private:
  bool cut(BitView bits, std::size_t most);
  bool cut_row(const std::uint64_t* row, int words, int y, std::size_t most);
  void join_rows(std::size_t above, std::size_t here, std::size_t end);
  std::int32_t root(std::int32_t i);

  std::optional<Limits> fixed_;
  Size size_;
  Limits limits_;
  std::vector<Run> runs_;
  std::vector<std::int32_t> forest_;  // over runs: the parent, or of a root minus its area
  std::vector<Component> components_;
};

}  // namespace cerberus::vision
