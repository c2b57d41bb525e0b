// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/difference_kernels.h"

#include <algorithm>
#include <bit>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/change/difference_kernels.cpp"
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

void tolerant_difference_row(const std::uint8_t* a, const std::uint8_t* above, const std::uint8_t* row,
                             const std::uint8_t* below, int count, std::uint8_t* out) {
  for (int x = 0; x < count; ++x) {
    std::uint8_t least = 255, most = 0;
    for (const std::uint8_t* r : {above, row, below})
      for (int u = x - 1; u <= x + 1; ++u) least = std::min(least, r[u]), most = std::max(most, r[u]);
    out[x] = static_cast<std::uint8_t>(a[x] < least ? least - a[x] : a[x] > most ? a[x] - most : 0);
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
HWY_EXPORT(tolerant_difference_row);
HWY_EXPORT(count_levels);

void difference_row(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(difference_row)(a, b, count, out);
}

void tolerant_difference_row(const std::uint8_t* a, const std::uint8_t* above, const std::uint8_t* row,
                             const std::uint8_t* below, int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(tolerant_difference_row)(a, above, row, below, count, out);
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
