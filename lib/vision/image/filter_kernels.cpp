// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/filter_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/image/filter_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void blur3_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int width,
               std::uint8_t* out) {
  constexpr int kChunk = 512;  // columns at a time, so that the sums stay on the stack and in the first cache
  std::uint16_t sums[kChunk + 2];  // of the three rows, with a column of margin on either side
  const auto column = [&](int x) { return static_cast<std::uint16_t>(above[x] + here[x] + below[x]); };
  for (int begin = 0; begin < width; begin += kChunk) {
    const int count = std::min(kChunk, width - begin);
    int x = 0;
#if HWY_TARGET != HWY_SCALAR
    const hn::ScalableTag<std::uint16_t> d;
    const hn::Rebind<std::uint8_t, decltype(d)> bytes;
    const int lanes = static_cast<int>(hn::Lanes(d));
    const auto load = [&](const std::uint8_t* p) { return hn::PromoteTo(d, hn::LoadU(bytes, p)); };
    for (; x + lanes <= count; x += lanes)
      hn::StoreU(hn::Add(hn::Add(load(above + begin + x), load(here + begin + x)), load(below + begin + x)),
                 d, sums + 1 + x);
#endif
    for (; x < count; ++x) sums[x + 1] = column(begin + x);
    sums[0] = column(std::max(begin - 1, 0));
    sums[count + 1] = column(std::min(begin + count, width - 1));
    // (n + 4) / 9 as (n + 4) * 7282 / 2^16: exact for n <= 9 * 255.
    x = 0;
#if HWY_TARGET != HWY_SCALAR
    const auto half = hn::Set(d, 4), ninth = hn::Set(d, 7282);
    for (; x + lanes <= count; x += lanes) {
      const auto n = hn::Add(hn::Add(hn::LoadU(d, sums + x), hn::LoadU(d, sums + x + 1)),
                             hn::Add(hn::LoadU(d, sums + x + 2), half));
      const auto mean = hn::BitCast(hn::RebindToSigned<decltype(d)>(), hn::MulHigh(n, ninth));
      hn::StoreU(hn::DemoteTo(bytes, mean), bytes, out + begin + x);
    }
#endif
    for (; x < count; ++x)
      out[begin + x] = static_cast<std::uint8_t>((sums[x] + sums[x + 1] + sums[x + 2] + 4u) * 7282u >> 16);
  }
}

void halve_rows(const std::uint8_t* upper, const std::uint8_t* lower, int width, std::uint8_t* out) {
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<std::uint16_t> d16;
  const hn::Repartition<std::uint8_t, decltype(d16)> d8;
  const hn::Rebind<std::uint8_t, decltype(d16)> half;
  const int lanes = static_cast<int>(hn::Lanes(d16));
  const auto low = hn::Set(d16, 255), two = hn::Set(d16, 2);
  const auto pairs = [&](const std::uint8_t* p) {
    const auto v = hn::BitCast(d16, hn::LoadU(d8, p));
    return hn::Add(hn::And(v, low), hn::ShiftRight<8>(v));
  };
  for (; x + lanes <= width; x += lanes) {
    const auto sum = hn::Add(hn::Add(pairs(upper + 2 * x), pairs(lower + 2 * x)), two);
    hn::StoreU(hn::DemoteTo(half, hn::BitCast(hn::RebindToSigned<decltype(d16)>(), hn::ShiftRight<2>(sum))),
               half, out + x);
  }
#endif
  for (; x < width; ++x)
    out[x] = static_cast<std::uint8_t>(
        (upper[2 * x] + upper[2 * x + 1] + lower[2 * x] + lower[2 * x + 1] + 2) / 4);
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(blur3_row);
HWY_EXPORT(halve_rows);

void blur3_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int width,
               std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(blur3_row)(above, here, below, width, out);
}

void halve_rows(const std::uint8_t* upper, const std::uint8_t* lower, int width, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(halve_rows)(upper, lower, width, out);
}

}  // namespace cerberus::vision
#endif
