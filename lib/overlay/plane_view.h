// SPDX-License-Identifier: LGPL-2.1-or-later
// Enlarges small planes to large pictures, for motionview.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::overlay {

// The picture to fill: grey bytes, or words of red, green and blue from the second highest byte down (cairo's RGB24).
struct Canvas {
  std::uint8_t* data = nullptr;
  std::ptrdiff_t stride = 0;  // bytes
  int width = 0, height = 0;
  bool gray = true;

  std::uint8_t* row(int y) const { return data + y * stride; }
  std::size_t row_bytes() const { return static_cast<std::size_t>(width) * (gray ? 1 : 4); }
  void fill_black() const;
  // Clears the bytes between the end of each row and the next one, because they are written to files too: equal
  // pictures have equal bytes. `bytes`: from data to the end of its memory.
  void clear_padding(std::size_t bytes) const;
};

// Fills a canvas with a plane of another size by nearest neighbour: a pixel shows the sample that covers its centre
// when both are scaled to the same area. Reuses its table from frame to frame.
class Enlarger {
 public:
  // Shows grey levels times gain, limited to white.
  void show(vision::GrayView plane, double gain, const Canvas& canvas);
  // Shows each label in its colour, 0 as black; only on a canvas of colours.
  void show_labels(vision::View<const std::uint16_t> plane, const Canvas& canvas);
  // Shows grey levels with the outlines of boxes, pixels of the plane, inside their edges; only on a canvas of colours.
  void show_boxes(vision::GrayView plane, std::span<const vision::Box> boxes, const Canvas& canvas);

 private:
  const std::vector<int>& columns(int from, int to);
  template <typename T, typename Write>
  void walk(vision::View<const T> plane, const Canvas& canvas, Write write);

  std::vector<int> columns_;  // for each column of a canvas its column in a plane `columns_from_` wide
  int columns_from_ = 0;
};

}  // namespace cerberus::overlay
