// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/candidate_kernels.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/background/candidate_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

// Bits of a mask are loaded and stored as bytes.
static_assert(std::endian::native == std::endian::little);

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET != HWY_SCALAR
constexpr int kLanes = 16;
static_assert(kLanes == kBrightness);  // a vector holds the limits of all classes
using D8 = hn::CappedTag<std::uint8_t, kLanes>;

HWY_INLINE hn::Vec<D8> difference(hn::Vec<D8> a, hn::Vec<D8> b) {
  return hn::Or(hn::SaturatedSub(a, b), hn::SaturatedSub(b, a));
}

// The 16 pixels from x on; readable kReach pixels before and after them.
HWY_INLINE void count(const CandidateRow& row, const CandidateLimits& limits, int x) {
  const D8 d;
  const auto load = [&](const std::uint8_t* p) HWY_ATTR { return hn::LoadU(d, p + x); };
  const auto set = [&](int v) HWY_ATTR { return hn::Set(d, static_cast<std::uint8_t>(v)); };
  const auto one = set(1), contrast = set(limits.contrast);
  constexpr int reach = CandidateRow::kReach;
  const auto f = load(row.frame), grey = load(row.grey), seen = load(row.seen);
  std::uint8_t bits[8] = {};
  std::memcpy(bits, reinterpret_cast<const std::uint8_t*>(row.foreground) + x / 8, kLanes / 8);
  const auto foreground = hn::LoadMaskBits(d, bits);

  const auto e = difference(f, grey);
  const auto limit = hn::TableLookupBytes(hn::LoadU(d, limits.same.data()), hn::ShiftRight<4>(grey));
  const auto shown = hn::AndNot(hn::Gt(e, limit), hn::Gt(seen, hn::Zero(d)));
  const auto edge = hn::Max(difference(load(row.frame + reach), load(row.frame - reach)),
                            difference(load(row.below), load(row.above)));
  const auto counts = hn::And(shown, hn::And(hn::Gt(load(row.quiet), hn::Zero(d)), hn::Gt(edge, contrast)));

  static_assert(CandidateRow::kFollow == 4 && CandidateRow::kOfAge == 4);
  const auto step = hn::ShiftRight<2>(e);
  const auto followed = hn::IfThenElse(hn::Gt(f, grey), hn::Add(grey, step), hn::Sub(grey, step));
  const auto replaced = hn::Not(hn::Or(shown, hn::Gt(seen, one)));
  const auto next_seen =
      hn::IfThenElse(counts, hn::SaturatedAdd(seen, one),
                     hn::IfThenElse(shown, seen, hn::Max(hn::SaturatedSub(seen, one), one)));
  const auto next_grey = hn::IfThenElse(shown, followed, hn::IfThenElse(replaced, f, grey));
  hn::StoreU(hn::IfThenElse(foreground, next_seen, seen), d, row.seen + x);
  hn::StoreU(hn::IfThenElse(foreground, next_grey, grey), d, row.grey + x);

  const auto lasts =
      hn::And(hn::And(foreground, shown), hn::And(hn::Gt(next_seen, set(limits.least_seen - 1)),
                                                  hn::Gt(next_seen, hn::ShiftRight<2>(load(row.age)))));
  hn::StoreMaskBits(d, lasts, bits);
  std::memcpy(reinterpret_cast<std::uint8_t*>(row.lasting) + x / 8, bits, kLanes / 8);
}
#endif

void count_candidates(const CandidateRow& row, const CandidateLimits& limits) {
  std::fill_n(row.lasting, bit_mask_size({row.width, 1}).width, std::uint64_t{0});
#if HWY_TARGET != HWY_SCALAR
  if (hn::Lanes(D8()) == kLanes) {
    for (int x = 0; x < row.width; x += kLanes) {
      std::uint16_t pixels;
      std::memcpy(&pixels, reinterpret_cast<const std::uint8_t*>(row.foreground) + x / 8, sizeof pixels);
      if (pixels == 0) continue;
      if (x < CandidateRow::kReach || x + kLanes + CandidateRow::kReach > row.width)
        count_candidates_reference(row, limits, x, std::min(x + kLanes, row.width));
      else
        count(row, limits, x);
    }
    return;
  }
#endif
  count_candidates_reference(row, limits, 0, row.width);
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(count_candidates);

void count_candidates(const CandidateRow& row, const CandidateLimits& limits) {
  HWY_DYNAMIC_DISPATCH(count_candidates)(row, limits);
}

void count_candidates_reference(const CandidateRow& row, const CandidateLimits& limits, int begin, int end) {
  constexpr int reach = CandidateRow::kReach;
  const auto is_edge = [&](int a, int b) { return std::abs(a - b) > limits.contrast; };
  for_bits(row.foreground, begin, end, [&](int x) {
    const int e = row.frame[x] - row.grey[x];
    std::uint8_t& seen = row.seen[x];
    if (seen > 0 && std::abs(e) <= limits.same[row.grey[x] / (256 / kBrightness)]) {
      const int left = std::max(x - reach, 0), right = std::min(x + reach, row.width - 1);
      if (row.quiet[x] > 0 && seen < 255 &&
          (is_edge(row.frame[left], row.frame[right]) || is_edge(row.above[x], row.below[x])))
        ++seen;
      row.grey[x] = static_cast<std::uint8_t>(row.grey[x] + e / CandidateRow::kFollow);
      if (seen >= limits.least_seen && seen > row.age[x] / CandidateRow::kOfAge)
        set_bits(row.lasting, x, x + 1);
    } else if (seen > 1) {
      --seen;
    } else {
      row.grey[x] = row.frame[x], seen = 1;
    }
  });
}

}  // namespace cerberus::vision
#endif
