// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loop of PeopleFinder, chosen for the processor at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace cerberus::vision {

// Sums over cells carry two numbers: foreground in the lower 16 bits, counted at all in the upper. Both, and differences
// of sums, are exact for so many cells.
constexpr std::uint32_t kCounted = 0x10000, kMoving = 1;
constexpr int kMostSummed = 32767;

// Rows of cells that a part of a body takes (head, trunk, legs), and what its cells gain: those within `core` columns
// of the axis, and those from there up to `reach`. Gains in 1/64, of a cell that is foreground and of one that is not; they
// and their difference fit into 16 bits with a sign.
struct BodyBand {
  const std::uint32_t* above = nullptr;  // above[x]: sum of all cells above the band and left of column x
  const std::uint32_t* below = nullptr;  // the same at the band's lower end
  int core = 0, reach = 0;               // columns, core <= reach
  int core_moving = 0, core_still = 0;
  int side_moving = 0, side_still = 0;
};
constexpr std::size_t kBodyBands = 4;  // free space, head, trunk, legs
using BodyBands = std::array<BodyBand, kBodyBands>;

// scores[x] := gain of a body with the axis at x, for first <= x < end. Returns the highest; first < end. Reads the sums of
// the columns [first - reach, end + reach) of each band.
int score_bodies(const BodyBands& body, int first, int end, int* scores);
int score_bodies_reference(const BodyBands& body, int first, int end, int* scores);

// A cell of the grid, one byte: bits.
constexpr std::uint8_t kCellMoving = 1, kCellCounted = 2, kCellExplained = 4;

}  // namespace cerberus::vision
