// SPDX-License-Identifier: LGPL-2.1-or-later
// Blur by the camera's own motion: a blurred edge differs from the sharp one although only the camera has moved.
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

  // Returns the sharpness of the frame relative to the background: the ratio of their sums of squared gradients, as the
  // median of the blocks with texture, which moving objects do not affect; to 2 %, from 1/16 to 16. Below 1 the frame is
  // blurred; 1 where there is too little texture. age: 0 where the model has no content; spans: the columns that the
  // frame covers, per row.
  double sharpness(GrayView frame, GrayView background, GrayView age, std::span<const RowSpan> spans);

  // Clears in both masks the pixels that blur alone explains. Blur along any path is a mean with weights that are not
  // negative: a blurred pixel is neither darker than the darkest nor brighter than the brightest of the sharp pixels
  // around it. `tolerance`: grey levels for noise, by brightness of the sharp pixel. `inner` is a subset of `bits`.
  void suppress(GrayView blurred, GrayView sharp, const std::array<std::uint8_t, kBrightness>& tolerance,
                MutableBitView bits, MutableBitView inner);

  std::size_t bytes() const { return low_.capacity() + high_.capacity(); }

 private:
  // low_, high_ := the range of the pixels within reach_ of each pixel of row y.
  void find_range(GrayView sharp, int y);

  int reach_ = 0;                         // pixels: blur to either side
  std::vector<std::uint8_t> low_, high_;  // a row with `reach_` columns of margin
};

}  // namespace cerberus::vision
