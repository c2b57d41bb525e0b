// SPDX-License-Identifier: LGPL-2.1-or-later
// Masks with one bit a pixel, 64 pixels in a machine word, so that set algebra, morphology and flood filling of
// a whole picture take a few microseconds.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>

#include "vision/image/image.h"

namespace cerberus::vision {

// Pixel x of a row is bit x % 64 of word x / 64. Bits beyond the width are 0 after every function of this
// header and of morphology.h (they read as "outside the picture").
using BitMask = Image<std::uint64_t, 1>;    // rows of whole words, not of whole vectors
using BitView = View<const std::uint64_t>;  // width counts words
using MutableBitView = View<std::uint64_t>;

// The size, in words, of the mask of a picture.
inline Size bit_mask_size(Size picture) {
  return {(picture.width + 63) / 64, picture.height};
}
// The bits of the last word of a row that are pixels.
inline std::uint64_t last_word_bits(int width) {
  return width % 64 ? (std::uint64_t{1} << (width % 64)) - 1 : ~std::uint64_t{0};
}

// Whether pixel x >= 0 of a row is set.
inline bool bit_at(const std::uint64_t* row, int x) {
  const auto at = static_cast<unsigned>(x);
  return row[at / 64] >> (at % 64) & 1;
}

// The bits first..end-1 of a word, 0 <= first < end <= 64.
inline std::uint64_t bits_between(int first, int end) {
  return ~std::uint64_t{0} >> (64 - (end - first)) << first;
}

// Calls each(word, ones) with the bits first..end-1 of a row, first >= 0, word by word.
template <typename Each>
void for_words(int first, int end, Each&& each) {
  for (int x = first; x < end;) {
    const int word = static_cast<int>(static_cast<unsigned>(x) / 64), stop = std::min(end, 64 * word + 64);
    each(word, bits_between(x - 64 * word, stop - 64 * word));
    x = stop;
  }
}
// Calls each(x) for the set ones of the bits first..end-1 of a row.
template <typename Each>
void for_bits(const std::uint64_t* row, int first, int end, Each&& each) {
  for_words(first, end, [&](int word, std::uint64_t ones) {
    for (std::uint64_t left = row[word] & ones; left; left &= left - 1)
      each(64 * word + std::countr_zero(left));
  });
}
inline void set_bits(std::uint64_t* row, int first, int end) {
  for_words(first, end, [row](int word, std::uint64_t ones) { row[word] |= ones; });
}
inline void clear_bits(std::uint64_t* row, int first, int end) {
  for_words(first, end, [row](int word, std::uint64_t ones) { row[word] &= ~ones; });
}

// d = 1 where the difference is above the threshold (paper Eq. 3): bits := picture > threshold (0..255).
void binarise(GrayView picture, int threshold, MutableBitView bits);
// Bits := picture != 0, and back: 255 where the bit is set, else 0.
void pack(GrayView mask, MutableBitView bits);
void unpack(BitView bits, MutableGrayView mask);

// Set algebra, all views of one size; the result may be one of the operands. M(k-1) = D(k) n D(k-1) is
// `intersect`, M(k) = D(k) - M(k-1) is `subtract` (the paper's words have it the other way round; its formula
// is meant).
void intersect(BitView a, BitView b, MutableBitView out);
void unite(BitView a, BitView b, MutableBitView out);
void subtract(BitView a, BitView b, MutableBitView out);

}  // namespace cerberus::vision
