// SPDX-License-Identifier: LGPL-2.1-or-later
// Reduces a mapped video frame to the small grey picture that is analysed, in one pass and without a copy of the
// frame.
#pragma once

#include <cstddef>
#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::vision {

// Describes where a frame holds its luma. One of three layouts: one luma sample every `pixel_stride` bytes (planar 1,
// YUY2 and UYVY 2); packed RGB of 3 or 4 bytes a pixel, whose luma is computed as (77 R + 150 G + 29 B) / 256, the
// BT.601 weights; one luma sample in every word of 16 bits, of which the upper 8 significant bits are used (P010,
// I420_10LE and similar), or the place between two values (LumaStretch). The truncation is below one grey level and equal in
// every frame.
struct LumaSource {
  const std::uint8_t* data = nullptr;  // first luma sample, or first byte of the first RGB pixel
  int width = 0;                       // pixels
  int height = 0;
  std::ptrdiff_t stride = 0;  // bytes between rows; may be far larger than a row, or negative
  int pixel_stride = 1;       // bytes between pixels
  bool rgb = false;
  int r = 0, g = 0, b = 0;  // byte offsets inside an RGB pixel
  int word_shift = 0;       // > 0: words of 16 bits, luma = min(255, word >> word_shift); pixel_stride is 2
  bool swapped = false;     // those words have the other byte order than this machine
  // span > 0: luma = 256 (word - low) / span instead, within 0 to 255; low and low + span are at most 65535.
  int low = 0, span = 0;
};

// The largest analysed picture: 32-bit counters and 16-bit coordinates do not overflow up to this size.
inline constexpr int kMaximumAnalysisSide = 3840;
inline constexpr long kMaximumAnalysisArea = 3840L * 2160;

// The analysis size for a frame: `analysis_width` wide with the frame's aspect, at least 16 rows; never
// larger than the frame (a small frame is analysed at its own size). analysis_width 0: the frame's own size. A result
// beyond kMaximumAnalysisSide in either direction, or beyond kMaximumAnalysisArea, is reduced with its aspect kept.
Size analysis_size(Size frame, int analysis_width);

// Reduces by area averaging: every source pixel is weighted by the share of it that lies in the target pixel.
// Never reads a byte behind the last sample of a row. The tables are reused: no allocation while the source's
// layout and the target's size stay the same. The target must not be larger than the source; at equal sizes the
// scaler copies (or converts RGB).
//
// Fixed point (16 bits vertically, 32 horizontally): the result is within one grey level of the exact
// average; equal sizes and a constant picture are exact.
class LumaScaler {
 public:
  void scale(const LumaSource& source, MutableGrayView target);
  std::size_t bytes() const {
    return rows_.bytes() + first_.bytes() + weights_.bytes() + column_sums_.bytes();
  }

 private:
  struct Rows {  // the source rows under one target row
    std::int32_t first, count;
    std::uint16_t first_weight, last_weight;  // of the first and last row; those between weigh 1 << shift_
    std::uint16_t reciprocal;                 // 65536 * 128 / sum of the weights
  };
  void prepare(const LumaSource& source, Size target);
  void prepare_rows(int source_height, int target_height);
  void prepare_columns(const LumaSource& source, int target_width);

  Image<Rows> rows_;                  // one a target row
  Image<std::int32_t> first_;         // first source byte of every target column
  Image<std::int16_t> weights_;       // blocks_ * 8 weights a target column, one a byte
  Image<std::uint16_t> column_sums_;  // one target row's vertical averages, a 128th grey level
  int shift_ = 0;
  int blocks_ = 0;  // weights of a target column in groups of 8
  int used_ = 0;    // bytes of a source row up to its last sample
  LumaSource source_;
  Size target_;
};

// The exact area average rounded to nearest, in integers, sample by sample: the reference for the tests of
// LumaScaler.
void scale_luma_reference(const LumaSource& source, MutableGrayView target);

}  // namespace cerberus::vision
