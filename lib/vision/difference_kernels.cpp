// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/difference_kernels.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/difference_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

// Bits of a mask are stored as bytes.
static_assert(std::endian::native == std::endian::little);

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void difference_row(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* out) {
  // A plain loop, compiled once per target: compilers vectorise it as well as intrinsics would.
  for (int x = 0; x < count; ++x) out[x] = static_cast<std::uint8_t>(a[x] > b[x] ? a[x] - b[x] : b[x] - a[x]);
}

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

void count_levels(const std::uint8_t* row, int count, LevelCounter::Counts& counts) {
  int x = 0;
#if HWY_TARGET != HWY_SCALAR
  constexpr int kNear = LevelCounter::kNear;
  const hn::CappedTag<std::uint8_t, LevelCounter::kLanes> d;
  using V = hn::Vec<decltype(d)>;
  const int lanes = static_cast<int>(hn::Lanes(d));
  while (x + lanes <= count) {
    if (counts.vectors == 255) counts.empty_near();
    const int vectors = std::min(255 - counts.vectors, (count - x) / lanes);
    counts.vectors += vectors;
    const auto near = [&](int level) { return counts.near[level].data(); };
    static_assert(kNear == 8);
    V n0 = hn::Load(d, near(0)), n1 = hn::Load(d, near(1)), n2 = hn::Load(d, near(2)),
      n3 = hn::Load(d, near(3));
    V n4 = hn::Load(d, near(4)), n5 = hn::Load(d, near(5)), n6 = hn::Load(d, near(6)),
      n7 = hn::Load(d, near(7));
    for (const int end = x + vectors * lanes; x < end; x += lanes) {
      const V v = hn::LoadU(d, row + x);
      // Subtracting a mask of ones (-1) adds one.
      const auto tally = [&](V n, std::uint8_t level) {
        return hn::Sub(n, hn::VecFromMask(d, hn::Eq(v, hn::Set(d, level))));
      };
      n0 = tally(n0, 0), n1 = tally(n1, 1), n2 = tally(n2, 2), n3 = tally(n3, 3);
      n4 = tally(n4, 4), n5 = tally(n5, 5), n6 = tally(n6, 6), n7 = tally(n7, 7);
      std::uint64_t far = 0;
      hn::StoreMaskBits(d, hn::Ne(hn::Min(v, hn::Set(d, kNear - 1)), v),
                        reinterpret_cast<std::uint8_t*>(&far));
      for (; far; far &= far - 1) ++counts.levels[row[x + std::countr_zero(far)]];
    }
    hn::Store(n0, d, near(0)), hn::Store(n1, d, near(1)), hn::Store(n2, d, near(2)),
        hn::Store(n3, d, near(3));
    hn::Store(n4, d, near(4)), hn::Store(n5, d, near(5)), hn::Store(n6, d, near(6)),
        hn::Store(n7, d, near(7));
  }
#endif
  for (; x < count; ++x) ++counts.levels[row[x]];
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(difference_row);
HWY_EXPORT(blur3_row);
HWY_EXPORT(count_levels);

void difference_row(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(difference_row)(a, b, count, out);
}
void blur3_row(const std::uint8_t* above, const std::uint8_t* here, const std::uint8_t* below, int width,
               std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(blur3_row)(above, here, below, width, out);
}

void LevelCounter::Counts::empty_near() {
  for (int level = 0; level < kNear; ++level)
    for (std::uint8_t& n : near[level]) levels[level] += n, n = 0;
  vectors = 0;
}
void LevelCounter::add(const std::uint8_t* row, int count) {
  HWY_DYNAMIC_DISPATCH(count_levels)(row, count, counts_);
}
void LevelCounter::store(std::array<std::uint32_t, 256>& histogram) {
  counts_.empty_near();
  histogram = counts_.levels;
}

}  // namespace cerberus::vision
#endif
