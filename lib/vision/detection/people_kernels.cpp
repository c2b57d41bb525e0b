// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/people_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/detection/people_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {

// A plain loop, compiled once per target: compilers vectorise it as well as intrinsics would.
void add_band(const BodyBand& band, int first, int end, int* HWY_RESTRICT scores) {
  const std::uint32_t *a = band.above, *b = band.below;
  const int core = band.core, reach = band.reach;
  // Gain of n cells of which m are foreground: m moving + (n - m) still = m (moving - still) + n still.
  const int core_moving = band.core_moving - band.core_still, core_still = band.core_still;
  const int side_moving = band.side_moving - band.side_still, side_still = band.side_still;
  for (int x = first; x < end; ++x) {
    const std::uint32_t inner = (b[x + core] - b[x - core]) - (a[x + core] - a[x - core]);
    const std::uint32_t outer = (b[x + reach] - b[x - reach]) - (a[x + reach] - a[x - reach]) - inner;
    scores[x] += static_cast<int>(inner & 0xffff) * core_moving + static_cast<int>(inner >> 16) * core_still +
                 static_cast<int>(outer & 0xffff) * side_moving + static_cast<int>(outer >> 16) * side_still;
  }
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(add_band);

void add_band(const BodyBand& band, int first, int end, int* scores) {
  HWY_DYNAMIC_DISPATCH(add_band)(band, first, end, scores);
}

// One column after the other.
void add_band_reference(const BodyBand& band, int first, int end, int* scores) {
  for (int x = first; x < end; ++x)
    for (int c = x - band.reach; c < x + band.reach; ++c) {
      const std::uint32_t cells = (band.below[c + 1] - band.below[c]) - (band.above[c + 1] - band.above[c]);
      const int moving = static_cast<int>(cells & 0xffff), still = static_cast<int>(cells >> 16) - moving;
      const bool core = c >= x - band.core && c < x + band.core;
      scores[x] += moving * (core ? band.core_moving : band.side_moving) +
                   still * (core ? band.core_still : band.side_still);
    }
}

}  // namespace cerberus::vision
#endif
