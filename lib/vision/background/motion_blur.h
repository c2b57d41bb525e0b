// SPDX-License-Identifier: LGPL-2.1-or-later
// Blur by the camera's own motion: an edge that is drawn out differs from the sharp one, and nothing has moved but the
// camera.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/background/background_kernels.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

class MotionBlur {
 public:
  void preallocate(Size picture);

  // How sharp the frame is beside the memory: sums of squared gradients, frame / memory, the median of the blocks with
  // texture, so that what moves has no say; to 2 %, from 1/16 to 16. Below 1: the frame is blurred. 1 where there is
  // too little texture. age: 0 where the memory knows nothing; spans: of the rows, what the frame shows of the memory.
  double sharpness(GrayView frame, GrayView memory, GrayView age, std::span<const RowSpan> spans);

  // Takes out of both masks what blur alone explains. Whatever its path, blur is a mean with weights that are not
  // negative: a blurred pixel is nowhere darker than the darkest, nor brighter than the brightest of the sharp ones
  // that were drawn together. `tolerance`: grey levels for noise, by brightness of the sharp pixel. `inner` is a subset
  // of `bits`.
  void forgive(GrayView blurred, GrayView sharp, const std::array<std::uint8_t, kBrightness>& tolerance,
               MutableBitView bits, MutableBitView inner);

  std::size_t bytes() const { return low_.capacity() + high_.capacity(); }

 private:
  // Columns of the rows around one, then of all pixels around.
  void find_range(GrayView sharp, int y);

  int reach_ = 0;                         // pixels that blur may draw to either side
  std::vector<std::uint8_t> low_, high_;  // a row with `reach_` columns of margin
};

}  // namespace cerberus::vision
