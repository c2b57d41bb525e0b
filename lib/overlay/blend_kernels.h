// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loops of blend(): a drawing (words of premultiplied alpha, red, green, blue from the highest byte down) on
// samples of 8 bits, with the vectors of the processor at hand. A call blends a whole drawing: the sides of boxes are
// about twelve pixels wide and hundreds of rows high, so that a call for each row would cost more than its pixels.
#pragma once

#include <cstddef>
#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::overlay {

// One component of the picture. The weights are 16.16, at most 1 in magnitude.
struct WeightedPlane {
  std::uint8_t* data = nullptr;  // of pixel (0, 0)
  std::ptrdiff_t stride = 0;     // bytes between rows of samples
  int step = 1;                  // bytes between samples
  std::int32_t red = 0, green = 0, blue = 0, alpha = 0;
};

// Components whose samples stand for the same pixels.
struct PlaneGroup {
  static constexpr int kMost = 4;
  WeightedPlane planes[kMost];
  int count = 0;
  int shift_x = 0, shift_y = 0;  // a sample stands for 2^shift pixels; shift_y at most 1

  int shift() const { return shift_x + shift_y; }
  int full() const { return 255 << shift(); }  // sum of alpha of a sample that is covered wholly
};

// Rows of the picture that are prefetched ahead of the one at hand: rows of a large frame lie further apart than
// processors prefetch by themselves (derived: 8 rows of 16 pixels take longer than a load from memory).
inline constexpr int kRowsAhead = 8;

// Blends the drawing, its upper left corner at pixel (x, y), into all planes of the group: with the weighted sum V
// (16.16) of the drawing's words that a sample stands for and the sum A of their alpha,
//   sample := (V + sample (full - A) 65536 / 255) / 2^(16 + shift), rounded.
// 65536 / 255 is taken as 257 + 1/256: at most .0004 of a grey level less.
void blend_planes(vision::View<const std::uint32_t> drawing, int x, int y, const PlaneGroup& group);

// The same for one sample, whose pixels are `count` words of each of two rows (`bottom` may be null): the reference,
// also used for the samples that do not fill a vector. u: the sample's column; v: its row.
void blend_sample(const std::uint32_t* top, const std::uint32_t* bottom, int count, const PlaneGroup& group,
                  int u, int v);

// A pixel of four bytes: for each the index of the word's byte (in memory order) with its colour, kKept for a byte that
// is no colour.
struct PackedLayout {
  static constexpr std::uint8_t kKept = 0x80;
  std::uint8_t color[4] = {kKept, kKept, kKept, kKept};
};

// byte := colour + byte (255 - alpha) / 255, rounded; `to`: the pixel under the drawing's upper left corner.
void blend_packed_pixel(std::uint32_t word, const PackedLayout& layout, std::uint8_t* to);
void blend_packed(vision::View<const std::uint32_t> drawing, const PackedLayout& layout, std::uint8_t* to,
                  std::ptrdiff_t stride);

}  // namespace cerberus::overlay
