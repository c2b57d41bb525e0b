// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/light_kernels.h"

#include <algorithm>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/change/light_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

// Plain loops, compiled once per target: compilers vectorise them as well as intrinsics would.
HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {

// Calls each(begin, bytes) for the pieces of a row. The caller copies each piece first, because `out` may be
// `reference` and possible aliasing would prevent vectorisation.
constexpr int kPiece = 32;
template <typename Each>
HWY_INLINE void in_pieces(int count, Each&& each) {
  for (int x = 0; x < count; x += kPiece) each(x, static_cast<std::size_t>(std::min(count - x, kPiece)));
}

void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  in_pieces(count, [&](int x, std::size_t bytes) {
    std::uint8_t levels[kPiece] = {};
    std::memcpy(levels, reference + x, bytes);
    for (std::uint8_t& level : levels) level = light(level);
    std::memcpy(out + x, levels, bytes);
  });
}

void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  if (light == RowLight{}) return HWY_NAMESPACE::relight_row(reference, light, count, out);
  in_pieces(count, [&](int at, std::size_t bytes) {
    std::uint8_t levels[kPiece] = {}, now_seen[kPiece] = {};
    std::memcpy(levels, reference + at, bytes);
    std::memcpy(now_seen, present + at, bytes);
    for (int x = 0; x < kPiece; ++x) {
      const std::uint8_t then = levels[x], seen = now_seen[x], now = light(then);
      const std::uint8_t low = then < now ? then : now, high = then < now ? now : then;
      const std::uint8_t most = then >= kWhite ? 255 : high;
      const std::uint8_t limited = seen < low ? low : seen > most ? most : seen;
      levels[x] = high >= kNearWhite ? limited : now;
    }
    std::memcpy(out + at, levels, bytes);
  });
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(relight_row);
HWY_EXPORT(relight_row_with_white);

void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(relight_row)(reference, light, count, out);
}
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(relight_row_with_white)(reference, present, light, count, out);
}

}  // namespace cerberus::vision
#endif
