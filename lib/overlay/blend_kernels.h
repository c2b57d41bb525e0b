// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loops of blend(): rows of a drawing (words of premultiplied alpha, red, green, blue from the highest byte
// down) on rows of 8-bit samples, with the vectors of the processor at hand.
#pragma once

#include <cstdint>

namespace cerberus::overlay {

// A row of samples of one component. A sample stands for one pixel of `top`, for two (`pairs`), or, with a `bottom`
// row, for twice as many: the kernels sum the weighted words, and the caller divides.
struct WeightedRow {
  const std::uint32_t* top = nullptr;
  const std::uint32_t* bottom = nullptr;  // null: no second row
  int samples = 0;
  bool pairs = false;
  std::int32_t red = 0, green = 0, blue = 0, alpha = 0;  // weights, 16.16; at most 1 in magnitude
  std::int32_t full = 255;  // alpha of a sample that is covered wholly: 255 a pixel
};

// value = weighted sum of the words, 16.16; rest = full - alpha. Returns false if every word is transparent; value and
// rest are not written then.
bool weigh(const WeightedRow& row, std::int32_t* value, std::int32_t* rest);

// The same for one sample whose pixels are `count` words of each of two rows: the reference, also used for the samples
// that do not fill a vector.
void weigh_sample(const WeightedRow& row, const std::uint32_t* top, const std::uint32_t* bottom, int count,
                  std::int32_t& value, std::int32_t& rest);

// sample := (value + sample rest 65536 / 255) / 2^(16 + shift), rounded, for samples side by side. 65536 / 255 is taken
// as 257 + 1/256: at most .0004 of a grey level less.
void mix(const std::int32_t* value, const std::int32_t* rest, int shift, int samples, std::uint8_t* to);
std::uint8_t mix_sample(std::int32_t value, std::int32_t rest, int shift, std::uint8_t sample);

// A pixel of four bytes: for each the index of the word's byte (in memory order) with its colour, kKept for a byte that
// is no colour.
struct PackedLayout {
  static constexpr std::uint8_t kKept = 0x80;
  std::uint8_t color[4] = {kKept, kKept, kKept, kKept};
};

// byte := colour + byte (255 - alpha) / 255, rounded.
void blend_packed_pixel(std::uint32_t word, const PackedLayout& layout, std::uint8_t* to);
void blend_packed(const std::uint32_t* from, const PackedLayout& layout, int pixels, std::uint8_t* to);

}  // namespace cerberus::overlay
