// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/light.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/light_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {

// A plain loop, compiled once per target: compilers vectorise it as well as intrinsics would.
// Saturating at the ends as a sensor does; a gain below 8 and an offset of a few hundred levels keep 32 bits safe.
void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  const std::int32_t gain = light.gain, offset = light.offset + 128;
  for (int x = 0; x < count; ++x) {
    const std::int32_t value = (reference[x] * gain + offset) >> 8;
    out[x] = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(relight_row);

void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(relight_row)(reference, light, count, out);
}

}  // namespace cerberus::vision
#endif
