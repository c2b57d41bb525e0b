// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/luma/luma_kernels.h"

#include <cstring>
#include <type_traits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/image/luma/luma_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Averages one vector of columns over all rows. load(row) returns the samples of one row as 16 bits of at most 255.
template <class D, class Load>
HWY_INLINE hn::Vec<D> average_vector(D d, const RowAverage& t, const std::uint8_t* p, const Load& load) {
  auto total = hn::Mul(load(p), hn::Set(d, t.first_weight));
  if (t.count > 1) {
    auto between = hn::Zero(d);
    p += t.stride;
    for (int i = 1; i < t.count - 1; ++i, p += t.stride) between = hn::Add(between, load(p));
    total = hn::Add(
        total, hn::Add(hn::ShiftLeftSame(between, t.shift), hn::Mul(load(p), hn::Set(d, t.last_weight))));
  }
  return hn::MulHigh(total, hn::Set(d, t.reciprocal));
}

struct LoadBytes {
  static constexpr int kBytes = 1;  // a sample
  template <class D>
  HWY_INLINE hn::Vec<D> operator()(D d, const RowAverage&, const std::uint8_t* p) const {
    return hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint8_t, D>(), p));
  }
};

struct LoadWords {
  static constexpr int kBytes = 2;
  template <class D>
  HWY_INLINE hn::Vec<D> operator()(D d, const RowAverage& t, const std::uint8_t* p) const {
#if HWY_TARGET == HWY_SCALAR
    std::uint16_t value;
    std::memcpy(&value, p, sizeof value);  // rows of words may begin at odd addresses
    auto word = hn::Set(d, value);
#else
    auto word = hn::LoadU(d, reinterpret_cast<const std::uint16_t*>(p));
#endif
    if (t.swapped) word = hn::Or(hn::ShiftLeft<8>(word), hn::ShiftRight<8>(word));
    const auto white = hn::Set(d, 255);
    if (t.stretch.span == 0) return hn::Min(hn::ShiftRightSame(word, t.word_shift), white);
    const auto above = hn::Min(hn::SaturatedSub(word, hn::Set(d, t.stretch.low)), hn::Set(d, t.stretch.span));
    return hn::Min(hn::MulHigh(hn::ShiftLeftSame(above, t.stretch.shift), hn::Set(d, t.stretch.factor)),
                   white);
  }
};

template <class Loader>
HWY_INLINE void average_samples(const RowAverage& t, int width, std::uint16_t* out) {
  const Loader loader;
  const auto at = [&](auto d, int x) HWY_ATTR {
    return average_vector(d, t, t.rows + static_cast<std::ptrdiff_t>(x) * Loader::kBytes,
                          [&](const std::uint8_t* p) HWY_ATTR { return loader(d, t, p); });
  };
  const hn::ScalableTag<std::uint16_t> d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  int x = 0;
  for (; x + lanes <= width; x += lanes) hn::StoreU(at(d, x), d, out + x);
  if (x == width) return;
  if (width >= lanes) {  // the last vector overlaps its neighbour: nothing behind the row is read
    x = width - lanes;
    hn::StoreU(at(d, x), d, out + x);
    return;
  }
  const hn::CappedTag<std::uint16_t, 1> one;
  for (; x < width; ++x) hn::StoreU(at(one, x), one, out + x);
}

void average_rows(const RowAverage& t, int width, std::uint16_t* out) {
  if (t.word_shift > 0)
    average_samples<LoadWords>(t, width, out);
  else
    average_samples<LoadBytes>(t, width, out);
}

// Sum of the products of one target pixel, spread over four lanes.
template <class D16, class D32, class Blocks>
HWY_INLINE hn::Vec<D32> column_products(D16 d16, D32 d32, const std::uint16_t* sums,
                                        const std::int16_t* weights, Blocks blocks) {
  auto even = hn::Zero(d32), odd = hn::Zero(d32);
  for (int i = 0; i < blocks; ++i) {
    const auto s = hn::LoadU(d16, reinterpret_cast<const std::int16_t*>(sums + 8 * i));
    even = hn::ReorderWidenMulAccumulate(d32, s, hn::LoadU(d16, weights + 8 * i), even, odd);
  }
  return hn::Add(even, odd);
}

#if HWY_TARGET != HWY_SCALAR
// Averages four pixels at a time; returns how many. `blocks`: an int, or a constant of that type for the usual number.
template <class Blocks>
HWY_INLINE int average_fours(const std::uint16_t* sums, const std::int32_t* first,
                             const std::int16_t* weights, Blocks blocks, int width, std::uint8_t* out) {
  const hn::FixedTag<std::int16_t, 8> d16;
  const hn::FixedTag<std::int32_t, 4> d32;
  const hn::FixedTag<std::uint8_t, 4> d8;
  const hn::Repartition<std::int64_t, decltype(d32)> d64;
  const int step = 8 * blocks;
  const auto products = [&](int i) {
    return column_products(d16, d32, sums + first[i], weights + static_cast<std::ptrdiff_t>(step) * i,
                           blocks);
  };
  // Two pixels' lanes folded into (a b a b), twice: lane n then holds pixel n.
  const auto fold = [&](auto a, auto b) {
    return hn::Add(hn::InterleaveLower(d32, a, b), hn::InterleaveUpper(d32, a, b));
  };
  const auto half = hn::Set(d32, 1 << 20);
  int j = 0;
  for (; j + 4 <= width; j += 4) {
    const auto ab = hn::BitCast(d64, fold(products(j), products(j + 1)));
    const auto cd = hn::BitCast(d64, fold(products(j + 2), products(j + 3)));
    const auto total = hn::Add(hn::BitCast(d32, hn::InterleaveLower(d64, ab, cd)),
                               hn::BitCast(d32, hn::InterleaveUpper(d64, ab, cd)));
    hn::StoreU(hn::DemoteTo(d8, hn::ShiftRight<21>(hn::Add(total, half))), d8, out + j);
  }
  return j;
}
#endif

void average_columns(const std::uint16_t* sums, const std::int32_t* first, const std::int16_t* weights,
                     int blocks, int width, std::uint8_t* out) {
  int j = 0;
#if HWY_TARGET != HWY_SCALAR
  if (blocks == 1)
    j = average_fours(sums, first, weights, std::integral_constant<int, 1>(), width, out);
  else
    j = average_fours(sums, first, weights, blocks, width, out);
#endif
  for (; j < width; ++j) {
    const std::uint16_t* s = sums + first[j];
    const std::int16_t* w = weights + static_cast<std::ptrdiff_t>(8) * blocks * j;
    std::int32_t total = 1 << 20;
    for (int i = 0; i < 8 * blocks; ++i) total += s[i] * w[i];
    out[j] = static_cast<std::uint8_t>(total >> 21);
  }
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(average_rows);
HWY_EXPORT(average_columns);

void average_rows(const RowAverage& task, int width, std::uint16_t* out) {
  HWY_DYNAMIC_DISPATCH(average_rows)(task, width, out);
}

void average_columns(const std::uint16_t* sums, const std::int32_t* first, const std::int16_t* weights,
                     int blocks, int width, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(average_columns)(sums, first, weights, blocks, width, out);
}

}  // namespace cerberus::vision
#endif
