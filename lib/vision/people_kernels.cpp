// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/people_kernels.h"

#include <climits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/people_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {

// Plain loops, compiled once per target: compilers vectorise them as well as intrinsics would.
int score_boxes(const BoxRow& row, int first, int end, int* HWY_RESTRICT scores) {
  const std::uint32_t *t = row.top, *b = row.bottom;
  const int w = row.width, q = row.side, left = row.left, right = row.right, high = row.rows;
  for (int l = first; l < end; ++l) {
    const std::uint32_t all = b[l + w] - b[l] - t[l + w] + t[l];
    const std::uint32_t core = b[l + w - q] - b[l + q] - t[l + w - q] + t[l + q];
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

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(score_boxes);

int score_boxes(const BoxRow& row, int first, int end, int* scores) {
  return HWY_DYNAMIC_DISPATCH(score_boxes)(row, first, end, scores);
}

}  // namespace cerberus::vision
#endif
