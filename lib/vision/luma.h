// SPDX-License-Identifier: LGPL-2.1-or-later
// From a mapped video frame to the small grey picture that is analysed: no copy of the frame, one pass over it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "vision/image.h"

namespace cerberus::vision {

// Where the brightness of a frame is. Either one luma sample every `pixel_stride` bytes (planar 1, YUY2 and UYVY 2),
// or packed RGB of 3 or 4 bytes a pixel, whose luma is computed (BT.601 weights, as GRAY8 conversion does).
struct LumaSource {
  const std::uint8_t* data = nullptr;  // first luma sample, or first byte of the first RGB pixel
  int width = 0;                       // pixels
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes between rows; may be far above the width
  int pixel_stride = 1;       // bytes between pixels
  bool rgb = false;
  int r = 0, g = 0, b = 0;  // byte offsets inside an RGB pixel
};

// The analysis size for a frame: `analysis_width` wide with the frame's aspect, at least 16 rows; never larger than
// the frame (a small frame is analysed as it is). analysis_width 0: the frame's own size.
Size analysis_size(Size frame, int analysis_width);

// Area-averaging reduction (every source pixel counts with the share of it that lies in the target pixel), 8-bit
// fixed-point weights. Scratch and tables are kept: no allocation while sizes stay the same. Target size must not
// exceed the source's; equal sizes copy (or convert RGB).
class LumaScaler {
 public:
  void scale(const LumaSource& source, MutableGrayView target);

 private:
  void prepare(const LumaSource& source, Size target);
  struct Tap {
    int first = 0, count = 0, weight = 0;  // see luma.cpp
  };
  // Implementation state: owned tables and one accumulator row.
  Image<std::uint32_t> accumulator_;
  Image<std::uint8_t> row_;
  Image<std::int32_t> columns_;
  Size source_size_, target_size_;
};

}  // namespace cerberus::vision
