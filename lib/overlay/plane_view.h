// SPDX-License-Identifier: LGPL-2.1-or-later
// Small planes as large pictures, for motionview: knows no GStreamer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

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
  // What lies between the end of a row and the next one is written to files too: equal pictures, equal bytes. `bytes`:
  // from data to the end of its memory.
  void clear_padding(std::size_t bytes) const;
};

// Fills a canvas with a plane of another size by nearest neighbour: a pixel shows the sample that covers its centre,
// the areas of both being the same. Keeps its table from frame to frame.
class Enlarger {
 public:
  // Grey levels times gain, up to white.
  void show(vision::GrayView plane, double gain, const Canvas& canvas);
  // A colour a label, black for none; only on a canvas of colours.
  void show_labels(vision::View<const std::uint16_t> plane, const Canvas& canvas);

 private:
  const std::vector<int>& columns(int from, int to);
  template <typename T, typename Write>
  void walk(vision::View<const T> plane, const Canvas& canvas, Write write);

  std::vector<int> columns_;  // where a canvas' columns lie in a plane `columns_from_` wide
  int columns_from_ = 0;
};

}  // namespace cerberus::overlay
