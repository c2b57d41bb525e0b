// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/people_kernels.h"

#include <algorithm>
#include <climits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/detection/people_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {

// Plain loops, compiled once per target: compilers vectorise them as well as intrinsics would.
int score_boxes(const BoxRow& row, int first, int end, int* HWY_RESTRICT scores) {
  const std::uint32_t* s = row.sums;
  const int w = row.width, q = row.side, left = row.left, right = row.right, high = row.rows;
  for (int l = first; l < end; ++l) {
    const std::uint32_t all = s[l + w] - s[l];
    const std::uint32_t core = s[l + w - q] - s[l + q];
    const std::uint32_t side = all - core;
    const int core_moving = core & 0xffff, core_still = static_cast<int>(core >> 16) - core_moving;
    const int side_moving = side & 0xffff, side_still = static_cast<int>(side >> 16) - side_moving;
    const int seen = ((l + w < right ? l + w : right) - (l > left ? l : left)) * high;
    scores[l] = core_moving * kCoreMoving + core_still * kCoreStill + side_moving * kSideMoving +
                side_still * kSideStill - seen * kPrice;
  }
  int highest = INT_MIN;
  for (int l = first; l < end; ++l) highest = scores[l] > highest ? scores[l] : highest;
  return highest;
}

inline std::uint32_t carried(std::uint8_t cell) {
  return cell & kCellExplained
             ? 0u
             : (cell & kCellMoving) * kMoving + (cell & kCellCounted) / kCellCounted * kCounted;
}
void add_cells(const std::uint8_t* HWY_RESTRICT cells, int columns, std::uint32_t* HWY_RESTRICT sums) {
  for (int c = 0; c < columns; ++c) sums[c] += carried(cells[c]);
}
void subtract_cells(const std::uint8_t* HWY_RESTRICT cells, int columns, std::uint32_t* HWY_RESTRICT sums) {
  for (int c = 0; c < columns; ++c) sums[c] -= carried(cells[c]);
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(score_boxes);
HWY_EXPORT(add_cells);
HWY_EXPORT(subtract_cells);

void add_cells(const std::uint8_t* cells, int columns, std::uint32_t* sums) {
  HWY_DYNAMIC_DISPATCH(add_cells)(cells, columns, sums);
}
void subtract_cells(const std::uint8_t* cells, int columns, std::uint32_t* sums) {
  HWY_DYNAMIC_DISPATCH(subtract_cells)(cells, columns, sums);
}

// One box after the other, one part after the other.
int score_boxes_reference(const BoxRow& row, int first, int end, int* scores) {
  int highest = INT_MIN;
  for (int l = first; l < end; ++l) {
    const auto part = [&](int from, int to, int moving, int still) {
      const std::uint32_t sum = row.sums[to] - row.sums[from];
      const int n = static_cast<int>(sum & 0xffff);
      return n * moving + (static_cast<int>(sum >> 16) - n) * still;
    };
    const int right = l + row.width;
    scores[l] = part(l, l + row.side, kSideMoving, kSideStill) +
                part(l + row.side, right - row.side, kCoreMoving, kCoreStill) +
                part(right - row.side, right, kSideMoving, kSideStill) - row.columns(l) * row.rows * kPrice;
    highest = std::max(highest, scores[l]);
  }
  return highest;
}

int score_boxes(const BoxRow& row, int first, int end, int* scores) {
  return HWY_DYNAMIC_DISPATCH(score_boxes)(row, first, end, scores);
}

}  // namespace cerberus::vision
#endif
