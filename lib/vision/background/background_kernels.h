// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loops of the background model, one row at a time (Highway, run-time dispatch), each with its scalar
// reference. Planes belong to Image: rows are read and written up to the next multiple of 16 samples, rows of bits by
// whole words (bits beyond the width become undefined).
#pragma once

#include <array>
#include <cstdint>

#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

constexpr int kBackgroundBlock = 16;  // side of a block of statistics, pixels
constexpr int kBrightness = 16;       // classes of brightness, for noise: grey level / 16

// Differences of a block of the frame from the background, for alignment: sums over the pixels of age > 0 that differ by
// at most kLargest. Gradients are twice the slope: b(x+1) - b(x-1).
struct BlockSums {
  static constexpr int kLargest = 60;
  std::int32_t xx = 0, xy = 0, yy = 0;  // gradient products
  std::int32_t xe = 0, ye = 0, ee = 0;  // with e = frame - background
  std::int32_t n = 0;
  std::int32_t ge = 0, gg = 0;  // |e| g and g^2 of the pixels with quiet >= quiet_from
  bool operator==(const BlockSums&) const = default;
};

struct BlockRows {
  GrayView frame, background, age, quiet;  // background: readable one pixel beyond every side
  int first = 0, end = 0;                  // rows to use, 1 <= first, end <= height - 1
  int step;                                // every step-th of them
  int quiet_from;  // ticks without motion from which a pixel counts for the registration error
};
// The block whose columns begin at x; columns outside [begin, end) are left out, with begin >= 1, end <= width - 1.
BlockSums block_sums(const BlockRows& rows, int x, int begin, int end);
BlockSums block_sums_reference(const BlockRows& rows, int x, int begin, int end);

// Length of a gradient from its two components, to 12 %: the larger one and half the smaller.
inline int gradient_length(int gx, int gy) {
  const int a = gx < 0 ? -gx : gx, b = gy < 0 ? -gy : gy;
  return a > b ? a + b / 2 : b + a / 2;
}

// One row of the comparison. Differences are in 1/16 grey level.
struct CompareRow {
  const std::uint8_t* frame = nullptr;
  // Rows of the background, readable at -1 and width.
  const std::uint8_t *above = nullptr, *background = nullptr, *below = nullptr;
  const std::uint8_t *spread = nullptr, *age = nullptr;
  const std::uint8_t* tolerance = nullptr;  // registration error, 1/16 pixel, per pixel
  const std::uint64_t* moved = nullptr;     // D(k) > Th
  std::uint8_t* quiet = nullptr;            // ticks since `moved`; counted up here ...
  int width = 0;
  int ticks = 0;  // ... by so many
};
struct CompareLimits {
  std::array<std::uint8_t, kBrightness> noise{};  // sigma of frame - background, 1/16 level
  static constexpr int weak_sigmas = 3, strong_sigmas = 5;
  static constexpr int weak_least = 6 * 16, strong_least = 9 * 16;  // 1/16 level
  static constexpr int young = 2;                                   // frames: below this age D(k) decides ...
  bool registered = false;  // ... and may itself be a registration error
};
// weak, strong: bits of the pixels that differ from the background by more than noise and registration explain. With
//   s = max(noise[b / 16], 5/4 spread), edge = |gradient of b| * tolerance, e = |frame - b|, b = background:
//   strong: e > max(strong_least, strong_sigmas s) + edge;  weak: the same with its own limits, or moved and
//   e > max(weak_least, weak_sigmas s): two pieces of evidence need no tolerance. Young pixels: both are
//   `moved`; where pictures had to be registered, strong also needs e > edge.
void compare_row(const CompareRow& row, const CompareLimits& limits, std::uint64_t* weak,
                 std::uint64_t* strong);
void compare_row_reference(const CompareRow& row, const CompareLimits& limits, std::uint64_t* weak,
                           std::uint64_t* strong);

// Learning rate by age in 1/256, 1 / (age + 1): exact up to 15, then by sixteens (at their middle), never below 3 /
// 256.
inline constexpr std::array<std::uint8_t, 16> kYoungRate{255, 128, 85, 64, 51, 43, 37, 32,
                                                         28,  26,  23, 21, 20, 18, 17, 16};
inline constexpr std::array<std::uint8_t, 16> kOldRate{28, 10, 6, 5, 4, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3, 3};

// One row of learning.
struct LearnRow {
  const std::uint8_t* frame = nullptr;
  const std::uint8_t* background = nullptr;  // as compared: under the frame's light
  const std::uint8_t* taken = nullptr;       // the frame as it is learnt: mostly under the model's light
  const std::uint8_t* quiet = nullptr;       // ticks
  const std::uint64_t* keep = nullptr;       // foreground: not learnt
  const std::uint64_t* absorb = nullptr;     // replaced at once by `taken`
  const std::uint64_t* valid = nullptr;      // covered by this frame
  std::uint16_t* mean = nullptr;             // grey level * 256
  std::uint8_t *spread = nullptr, *age = nullptr;
  int width = 0;
  int phase = 0;  // 0 or 15, alternating: rounding of the spread
  int tick = 0;   // frames for which `quiet` counts one; at most 128
};
// mean += rate(age) (frame - background), rate = 1 / (age + 1) down to 3 / 256; spread follows
// 16 |frame - background| with 1/16; age + 1. Pixels of age 0 and absorbed ones are set to `taken`;
// an absorbed one is then half as old as it has been learnt, or has rested where that is less, and at least 2.
void learn_row(const LearnRow& row);
void learn_row_reference(const LearnRow& row);

// out := round(mean / 256).
void round_row(const std::uint16_t* mean, int width, std::uint8_t* out);

}  // namespace cerberus::vision
