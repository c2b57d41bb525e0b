// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/people_kernels.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/detection/people_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Scores one column after the other: fewer than a vector has.
int score_few(const BodyBands& body, int first, int end, int* scores) {
  int most = hwy::LowestValue<std::int32_t>();
  for (int x = first; x < end; ++x) {
    int score = 0;
    for (const BodyBand& band : body) {
      const auto gain = [&](int reach, int moving, int still) {
        const std::uint32_t cells =
            (band.below[x + reach] - band.below[x - reach]) - (band.above[x + reach] - band.above[x - reach]);
        const int foreground = static_cast<int>(cells & 0xffff), all = static_cast<int>(cells >> 16);
        return foreground * moving + (all - foreground) * still;
      };
      // Every cell as one at the side, and what one of the core gains more.
      score += gain(band.reach, band.side_moving, band.side_still) +
               gain(band.core, band.core_moving - band.side_moving, band.core_still - band.side_still);
    }
    scores[x] = score;
    most = std::max(most, score);
  }
  return most;
}

#if HWY_TARGET == HWY_SCALAR
int score_bodies(const BodyBands& body, int first, int end, int* scores) {
  return score_few(body, first, end, scores);
}
#else

// Gain of n cells of which m are foreground: m moving + (n - m) still = m (moving - still) + n still. Both factors in one
// lane, in the order of the sums.
HWY_INLINE std::uint32_t factors(int moving, int still) {
  return static_cast<std::uint32_t>(still) << 16 | (static_cast<std::uint32_t>(moving - still) & 0xffff);
}

// Scores as many columns from x on as D has lanes.
template <class D>
HWY_INLINE hn::Vec<D> score_columns(D d, const BodyBands& body, const std::uint32_t* core_factors,
                                    const std::uint32_t* side_factors, int x) {
  const hn::RebindToUnsigned<D> sums;
  const hn::Repartition<std::int16_t, D> halves;
  const auto between = [&](const std::uint32_t* row, int reach) HWY_ATTR {
    return hn::Sub(hn::LoadU(sums, row + x + reach), hn::LoadU(sums, row + x - reach));
  };
  auto even = hn::Zero(d), odd = hn::Zero(d);
  const auto add = [&](auto cells, std::uint32_t by) HWY_ATTR {
    even = hn::ReorderWidenMulAccumulate(d, hn::BitCast(halves, cells),
                                         hn::BitCast(halves, hn::Set(sums, by)), even, odd);
  };
  for (std::size_t i = 0; i < kBodyBands; ++i) {
    const BodyBand& band = body[i];
    const auto inner = hn::Sub(between(band.below, band.core), between(band.above, band.core));
    const auto all = hn::Sub(between(band.below, band.reach), between(band.above, band.reach));
    add(inner, core_factors[i]);
    add(hn::Sub(all, inner), side_factors[i]);
  }
  return hn::RearrangeToOddPlusEven(even, odd);
}

// Scores columns by whole vectors, the last of which may score some a second time; end - first is at least a vector.
template <class D>
HWY_INLINE int score_row(D d, const BodyBands& body, const std::uint32_t* core_factors,
                         const std::uint32_t* side_factors, int first, int end, int* scores) {
  const int lanes = static_cast<int>(hn::Lanes(d));
  auto most = hn::Set(d, hwy::LowestValue<std::int32_t>());
  for (int at = first; at < end; at += lanes) {
    const int x = std::min(at, end - lanes);
    const auto score = score_columns(d, body, core_factors, side_factors, x);
    hn::StoreU(score, d, scores + x);
    most = hn::Max(most, score);
  }
  return hn::GetLane(hn::MaxOfLanes(d, most));
}

int score_bodies(const BodyBands& body, int first, int end, int* scores) {
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::CappedTag<std::int32_t, 4> few;
  if (end - first < static_cast<int>(hn::Lanes(few))) return score_few(body, first, end, scores);
  std::uint32_t core[kBodyBands], side[kBodyBands];
  for (std::size_t i = 0; i < kBodyBands; ++i) {
    core[i] = factors(body[i].core_moving, body[i].core_still);
    side[i] = factors(body[i].side_moving, body[i].side_still);
  }
  if (end - first < static_cast<int>(hn::Lanes(d)))
    return score_row(few, body, core, side, first, end, scores);
  return score_row(d, body, core, side, first, end, scores);
}
#endif

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(score_bodies);

int score_bodies(const BodyBands& body, int first, int end, int* scores) {
  return HWY_DYNAMIC_DISPATCH(score_bodies)(body, first, end, scores);
}

// One cell column after the other.
int score_bodies_reference(const BodyBands& body, int first, int end, int* scores) {
  for (int x = first; x < end; ++x) {
    scores[x] = 0;
    for (const BodyBand& band : body)
      for (int c = x - band.reach; c < x + band.reach; ++c) {
        const std::uint32_t cells = (band.below[c + 1] - band.below[c]) - (band.above[c + 1] - band.above[c]);
        const int moving = static_cast<int>(cells & 0xffff), still = static_cast<int>(cells >> 16) - moving;
        const bool core = c >= x - band.core && c < x + band.core;
        scores[x] += moving * (core ? band.core_moving : band.side_moving) +
                     still * (core ? band.core_still : band.side_still);
      }
  }
  return *std::max_element(scores + first, scores + end);
}

}  // namespace cerberus::vision
#endif
