// SPDX-License-Identifier: LGPL-2.1-or-later
// The background beyond the picture, coarsely. A camera that turns back finds a learnt background there; otherwise the
// model would start anew at the picture's edge with every frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/transform.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// The background model, plane by plane (background_model.h).
struct BackgroundPixels {
  View<std::uint16_t> mean;  // grey level * 256
  View<std::uint8_t> spread, age, quiet;
};

// The mosaic is two and a half pictures wide and one and a quarter high and takes a tenth of a byte a pixel of it. It
// holds the means of 4 x 4 pixels, and of 8 x 8 pixels the largest spread, which includes the deviation from the means,
// and the smallest age. Its own coordinates never change by interpolation, so a camera that turns to and fro blurs
// nothing. When the picture leaves the mosaic, the mosaic follows and drops its far end.
class Mosaic {
 public:
  static constexpr int kCell = 8;  // pixels
  // Frames: restored content is at most this old, as its details have to be learnt again.
  static constexpr std::uint8_t kOldest = 4;

  // Allocates for pictures of this size and resets.
  void preallocate(Size picture);
  // Empties the mosaic and puts the picture in its middle.
  void reset(Size picture);

  // Stores the content that leaves the picture when the model moves by `next` (pixel now to pixel then). Called before
  // the move.
  void store(const BackgroundPixels& pixels, const Transform& next);
  // Called after the move: fills pixels of age 0 in the part that came into the picture from the mosaic. They count as
  // moving in this frame (quiet 0), as no earlier frame shows whether they move.
  void restore(const BackgroundPixels& pixels, const Transform& next);
  // Drops the content of the last restore() if the frame is darker, or brighter, in most of it: its light has changed
  // out of view. background: `pixels.mean` as it is compared; visible: the columns that the frame covers, per row.
  void verify(const BackgroundPixels& pixels, GrayView frame, GrayView background,
              std::span<const RowSpan> visible);
  // mean := gain * mean + offset, like the model's; gain in 1/256, offset in 1/256 grey level.
  void relight(int gain, int offset);

  std::size_t bytes() const { return cells_.capacity() * sizeof(Cell); }

 private:
  struct Cell {
    std::uint8_t mean[4] = {};         // of its quarters, in reading order
    std::uint8_t spread = 0, age = 0;  // age 0: empty
  };
  // Pixels of the model from (left, top) up to but not including (right, bottom).
  struct Area {
    int left, top, right, bottom;
  };

  // Calls f with the one or two areas of a picture that a motion uncovers.
  template <typename F>
  static void for_each_uncovered(const Transform& motion, Size size, F&& f);
  void store_area(const BackgroundPixels& pixels, const Transform& next, const Area& area);
  void restore_area(const BackgroundPixels& pixels, const Area& area);
  void scroll(Size picture);
  static Cell summary(const BackgroundPixels& pixels, int left, int top);
  View<Cell> cells() { return {cells_.data(), columns_, rows_, columns_}; }

  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
  Transform to_mosaic_;  // model pixel to mosaic pixel
  bool empty_ = true;
  Transform restored_;  // by the last restore(); identity: nothing to verify
};

}  // namespace cerberus::vision
