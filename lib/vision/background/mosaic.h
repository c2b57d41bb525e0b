// SPDX-License-Identifier: LGPL-2.1-or-later
// What lies beyond the picture, coarsely: a camera that turns back finds the scene that it knows, where it would have
// to begin anew at the picture's edge, with every frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vision/geometry/transform.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// The scene's memory, plane by plane (scene_memory.h).
struct BackgroundPixels {
  View<std::uint16_t> mean;  // grey level * 256
  View<std::uint8_t> spread, age, quiet;
};

// A mosaic of the size of two and a half pictures by one and a quarter, a tenth of a byte a pixel of it: means of 4 x 4
// pixels; of 8 x 8, the largest spread, which counts what the means leave out, and the smallest age. It has coordinates
// of its own, so that nothing in it is drawn twice: a camera that turns to and fro blurs nothing. The picture may leave
// it, then it follows, and forgets what is farthest away.
class Mosaic {
 public:
  static constexpr int kCell = 8;  // pixels
  // What comes back is learnt on as if it were no older: its details have to be learnt again.
  static constexpr std::uint8_t kOldest = 4;

  // Takes the memory for pictures of this size, and begins.
  void preallocate(Size picture);
  // Nothing is known but what the picture shows.
  void begin(Size picture);

  // The memory's content is about to move by `next` (pixel now to pixel then). Keeps what will leave the picture.
  void keep(const BackgroundPixels& pixels, const Transform& next);
  // It has moved. What nobody knows (age 0) in the part that came into the picture is taken from what was kept; it
  // counts as moving for the moment (quiet 0), because nobody can know.
  void recall(const BackgroundPixels& pixels, const Transform& next);
  // What recall() brought last is forgotten again where it is not true any more: when the frame has most of it darker
  // or brighter, its light has changed while it was out of view. memory: `pixels.mean` as it is compared; shown: what
  // the frame shows of each row.
  void doubt(const BackgroundPixels& pixels, GrayView present, GrayView memory,
             std::span<const RowSpan> shown);
  // mean := gain * mean + offset, as the memory's; gain in 1/256, offset in 1/256 grey level.
  void relight(int gain, int offset);

  std::size_t bytes() const { return cells_.capacity() * sizeof(Cell); }

 private:
  struct Cell {
    std::uint8_t mean[4] = {};         // of its quarters, in reading order
    std::uint8_t spread = 0, age = 0;  // age 0: nothing is known
  };
  // Pixels of the memory from (left, top) up to but not including (right, bottom).
  struct Part {
    int left, top, right, bottom;
  };

  // Calls f with the one or two parts of a picture that a motion uncovers.
  template <typename F>
  static void for_each_uncovered(const Transform& motion, Size size, F&& f);
  void keep_part(const BackgroundPixels& pixels, const Transform& next, const Part& part);
  void recall_part(const BackgroundPixels& pixels, const Part& part);
  void follow(Size picture);
  static Cell summary(const BackgroundPixels& pixels, int left, int top);
  View<Cell> cells() { return {cells_.data(), columns_, rows_, columns_}; }

  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
  Transform place_;  // memory pixel to mosaic pixel
  bool empty_ = true;
  Transform last_;  // of recall(); identity: nothing to doubt
};

}  // namespace cerberus::vision
