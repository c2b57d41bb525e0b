// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of LumaScaler, chosen for the processor at run time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cerberus::vision {

// Luma of words between two values: min(255, (min(saturated word - low, span) << shift) factor >> 16). span 0: not so.
struct WordStretch {
  std::uint16_t low = 0, span = 0, factor = 0;
  int shift = 0;
};
// factor / 65536 = 256 / (span << shift), rounded down, where span << shift has 16 bits: at most one level too dark.
inline WordStretch stretch_of(int low, int span) {
  if (span <= 0) return {};
  int shift = 0;
  while (span << (shift + 1) <= 65535) ++shift;
  const int factor = (256 << 16) / (span << shift);
  return {static_cast<std::uint16_t>(low), static_cast<std::uint16_t>(span),
          static_cast<std::uint16_t>(factor), shift};
}

// Vertical averages of `count` rows of `width` bytes, or (word_shift > 0) of `width` words of 16 bits, each of which
// stands for min(255, word >> word_shift), or as `stretch` says, its bytes swapped first where the words have the other byte
// order:
// out[x] = (first_weight * row[0][x] + ((row[1][x] + ... + row[count-2][x]) << shift) + last_weight *
// row[count-1][x])
//          * reciprocal >> 16.
// The bracket must not exceed 65535: the weights sum to at most 257. count >= 1; a single row has
// first_weight only.
struct RowAverage {
  const std::uint8_t* rows;
  std::ptrdiff_t stride;
  int count;
  int shift;
  std::uint16_t first_weight, last_weight, reciprocal;
  int word_shift = 0;
  bool swapped = false;
  WordStretch stretch;
};
void average_rows(const RowAverage& task, int width, std::uint16_t* out);

// Horizontal averages: out[j] = (sum over i < 8 * blocks of sums[first[j] + i] * weights[8 * blocks * j + i]
// + 2^20)
// >> 21. Sums below 32768, the weights of one j add up to 2^14; sums[] is readable (any value) 8 * blocks
// past first[j].
void average_columns(const std::uint16_t* sums, const std::int32_t* first, const std::int16_t* weights,
                     int blocks, int width, std::uint8_t* out);

}  // namespace cerberus::vision
