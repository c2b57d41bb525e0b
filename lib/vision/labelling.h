// SPDX-License-Identifier: LGPL-2.1-or-later
// Connected components of a mask with their statistics, by runs.
//
// A row is cut into runs of moving pixels; a run joins every run of the row above that it touches
// (8-connected) in a union-find forest whose root is always the earliest run, so that labels come out in
// reading order of the components' first pixels whatever the shape (L. He, Y. Chao, K. Suzuki, "A run-based
// two-scan labeling algorithm", IEEE Trans. Image Processing 17(5), 2008, is the idea). The statistics are
// sums over runs, not over pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/image.h"
#include "vision/transform.h"

namespace cerberus::vision {

struct Component {
  int left = 0, top = 0;      // first column and row
  int right = 0, bottom = 0;  // one past the last column and row
  std::uint32_t area = 0;     // pixels
  std::uint64_t sum_x = 0;    // of the pixels' columns and rows
  std::uint64_t sum_y = 0;

  int width() const { return right - left; }
  int height() const { return bottom - top; }
  Point centroid() const { return {static_cast<double>(sum_x) / area, static_cast<double>(sum_y) / area}; }
};

// One horizontal stretch of moving pixels.
struct Run {
  std::int32_t row = 0;
  std::int32_t first = 0, end = 0;  // columns, end is one past the last
  std::uint32_t component = 0;      // index into components()
};

class Labeller {
 public:
  // Finds the components of the pixels that are not 0 (8-connected). Component i carries label i + 1. No
  // limit on their number; the label picture has 16 bits, so label() writes 65535 for every component from
  // the 65535th on. The spans live until the next call. Memory grows to the busiest picture seen and stays;
  // nothing is allocated once it has.
  std::span<const Component> find(GrayView mask);

  // Forgets the components smaller than `least` pixels, sets their pixels in the mask to 0 and numbers the others anew
  // in the same order. mask: the one that find() was given.
  std::span<const Component> drop_smaller(std::uint32_t least, MutableGrayView mask);

  std::span<const Component> components() const { return components_; }
  // In reading order.
  std::span<const Run> runs() const { return runs_; }

  // labels := label of each pixel, 0 where nothing moves. Size as the mask's.
  void write(View<std::uint16_t> labels) const;

  std::size_t bytes() const;

 private:
  void cut_row(const std::uint8_t* row, int width, int y);
  void join_rows(std::size_t above, std::size_t here, std::size_t end);
  std::uint32_t root(std::uint32_t i);

  std::vector<Run> runs_;
  std::vector<std::uint32_t> parent_;  // forest over runs: parent_[i] <= i
  std::vector<Component> components_;
};

}  // namespace cerberus::vision
