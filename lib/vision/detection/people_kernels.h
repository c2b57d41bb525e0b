// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of PeopleFinder, chosen for the processor at run time.
#pragma once

#include <cstdint>

namespace cerberus::vision {

// Log-likelihood ratio of one cell for a person at its place, in 1/64: 64 ln(p / p0) where the cell is foreground and
// 64 ln((1 - p) / (1 - p0)) where it is not. derived: p = .65 in the core, .35 in the outer columns, p0 = .04 elsewhere.
constexpr int kCoreMoving = 178, kCoreStill = -65;
constexpr int kSideMoving = 139, kSideStill = -25;
// Price of one cell of the box in 1/64 (0.4). A whole person gains 1 to 1.7 a cell. Guard: boxes on vtest.avi.
constexpr int kPrice = 26;

// One cell carries two numbers: foreground in the lower 16 bits, counted at all in the upper. Sums of up to 65535 cells,
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

// scores[l], first <= l < end: gain of a person with the left edge at l, less its price, 1/64. Returns the highest.
int score_boxes(const BoxRow& row, int first, int end, int* scores);
int score_boxes_reference(const BoxRow& row, int first, int end, int* scores);

// A cell of the grid, one byte: bits.
constexpr std::uint8_t kCellMoving = 1, kCellCounted = 2, kCellExplained = 4;

// sums[c] += (or -=) the two numbers of cell c; 0 if it is explained.
void add_cells(const std::uint8_t* cells, int columns, std::uint32_t* sums);
void subtract_cells(const std::uint8_t* cells, int columns, std::uint32_t* sums);

}  // namespace cerberus::vision
