// SPDX-License-Identifier: LGPL-2.1-or-later
// The inner loop of looking for people, chosen for the processor at run time.
#pragma once

#include <cstdint>

namespace cerberus::vision {

// What a cell says for a person: 64 ln(p / kOutside) where it moves and 64 ln((1 - p) / (1 - kOutside)) where it does
// not, with p = .65 in the core, .35 at the sides and kOutside = .04; and what a cell of the box costs.
constexpr int kCoreMoving = 178, kCoreStill = -65;
constexpr int kSideMoving = 139, kSideStill = -25;
constexpr int kPrice = 26;  // 0.4 for each cell of the box; a whole person brings 1 to 1.7

// One cell carries two numbers: moving in the lower 16 bits, counted at all in the upper. Sums of up to 65535 cells,
// and differences of sums, are exact in both halves.
constexpr std::uint32_t kCounted = 0x10000, kMoving = 1;

// Boxes of one size and height in the picture, by the column of their left edge.
struct BoxRow {
  const std::uint32_t* sums = nullptr;  // sums[x]: of all cells in the boxes' rows and columns before x
  int width = 0, side = 0;              // of the box; of the outer part on either side
  int left = 0, right = 0, rows = 0;    // the picture's columns, and how many rows of the box lie in it
  // Columns of the box in the picture.
  int columns(int l) const { return (l + width < right ? l + width : right) - (l > left ? l : left); }
};

// scores[l], first <= l < end: what a person there gains, less its price. Returns the highest.
int score_boxes(const BoxRow& row, int first, int end, int* scores);
int score_boxes_reference(const BoxRow& row, int first, int end, int* scores);

// What a cell of the grid is, one byte a cell.
constexpr std::uint8_t kCellMoving = 1, kCellCounted = 2, kCellExplained = 4;

// sums[c] += (or -=) what cell c carries: nothing once it is explained.
void add_cells(const std::uint8_t* cells, int columns, std::uint32_t* sums);
void subtract_cells(const std::uint8_t* cells, int columns, std::uint32_t* sums);

}  // namespace cerberus::vision
