// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of bit masks, chosen for the processor at run time. The tests compare them with the references in
// morphology.h, one pixel at a time, and with single bits.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cerberus::vision {

// bits := row > limit, whole words; 0 beyond the width.
void binarise_row(const std::uint8_t* row, int width, std::uint8_t limit, std::uint64_t* bits);
// row := 255 where a bit is set, else 0.
void unpack_row(const std::uint64_t* bits, int width, std::uint8_t* row);

// words[k] |= words[k + distance] for the first `count` words, and words[k] |= words[k - distance] for `count` words
// from the distance-th on, as if all were read before one is written.
void unite_with_later(std::uint64_t* words, std::size_t count, std::size_t distance);
void unite_with_earlier(std::uint64_t* words, std::size_t count, std::size_t distance);

}  // namespace cerberus::vision
