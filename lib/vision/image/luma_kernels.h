// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of LumaScaler, chosen for the processor at run time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cerberus::vision {

// Vertical averages of `count` rows of `width` bytes, or (word_shift > 0) of `width` words of 16 bits, each of which
// stands for min(255, word >> word_shift), its bytes swapped first where the words have the other byte order:
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
};
void average_rows(const RowAverage& task, int width, std::uint16_t* out);

// Horizontal averages: out[j] = (sum over i < 8 * blocks of sums[first[j] + i] * weights[8 * blocks * j + i]
// + 2^20)
// >> 21. Sums below 32768, the weights of one j add up to 2^14; sums[] is readable (any value) 8 * blocks
// past first[j].
void average_columns(const std::uint16_t* sums, const std::int32_t* first, const std::int16_t* weights,
                     int blocks, int width, std::uint8_t* out);

}  // namespace cerberus::vision
