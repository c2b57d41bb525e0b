// SPDX-License-Identifier: LGPL-2.1-or-later
// Connected components of a mask with their boxes and areas, found by runs.
//
// The labeller cuts each row into runs of moving pixels and joins a run with every run of the row above that it
// touches (8-connected) in a union-find forest. The root of a tree is always its earliest run, so that labels are in
// reading order of the components' first pixels for every shape. Areas are sums over runs, not over pixels. Source of
// the idea: L. He, Y. Chao, K. Suzuki, "A run-based two-scan labeling algorithm", IEEE Trans. Image Processing 17(5),
// 2008.
#pragma once

#include <algorithm>
#include <cstddef>
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

// Distance between two extents (columns or rows) in pixels; below 0 where they overlap.
constexpr int gap(int a_from, int a_to, int b_from, int b_to) {
  return (a_from > b_from ? a_from : b_from) - (a_to < b_to ? a_to : b_to);
}

// Returns whether two components lie less than `pixels` apart, both across and down.
constexpr bool are_within(double pixels, const Component& a, const Component& b) {
  return gap(a.left, a.right, b.left, b.right) < pixels && gap(a.top, a.bottom, b.top, b.bottom) < pixels;
}

// One horizontal stretch of moving pixels. 16 bits suffice: analysed pictures are at most 65535 wide and high.
struct Run {
  std::uint16_t row = 0;
  std::uint16_t first = 0, end = 0;  // columns, end is one past the last
  std::uint16_t component = 0;       // index into components()
};

// Calls each(run) for the runs of component number `self`. runs: those of all components, in reading order.
template <typename Each>
void for_runs(const Component& component, std::size_t self, std::span<const Run> runs, Each&& each) {
  auto run = std::ranges::lower_bound(runs, component.top, {}, &Run::row);
  for (; run != runs.end() && run->row < component.bottom; ++run)
    if (run->component == self) each(*run);
}

class Labeller {
 public:
  // The largest numbers of runs and components that the labeller stores; at most 65535 of each.
  struct Limits {
    std::size_t runs = 0, components = 0;
  };
  // Derives the limits from the picture's size: several times the runs and components of a busy street.
  Labeller() = default;
  explicit Labeller(const Limits& limits) : fixed_(limits) {}

  // Allocates the memory for pictures of this size; find() calls it first.
  void preallocate(Size picture);

  // Finds the components of the set bits (8-connected) that have at least `least` pixels and clears the bits of smaller
  // ones. Component i has the label i + 1. width: the picture's width in pixels.
  // Memory is bounded and allocated at the first picture of a size. A mask beyond the limits is clutter (rain, a
  // failing sensor): small parts are removed until it fits, by openings with growing squares while there are too many
  // runs, by doubling `least` while there are too many components. On return the set bits are exactly the pixels of the
  // returned components. The spans are valid until the next call.
  std::span<const Component> find(MutableBitView bits, int width, std::uint32_t least = 1);

  const Limits& limits() const { return limits_; }
  std::span<const Component> components() const { return components_; }
  // In reading order.
  std::span<const Run> runs() const { return runs_; }

  // labels := the label of each pixel, 0 for background. labels has the mask's size.
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
  std::vector<std::int32_t> forest_;  // for each run its parent; for a root minus the component's area
  std::vector<Component> components_;
};

}  // namespace cerberus::vision
