// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/background_kernels.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/background/background_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

// Bits of a mask are loaded and stored as bytes.
static_assert(std::endian::native == std::endian::little);

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR
BlockSums block_sums(const BlockRows& rows, int x, int begin, int end) {
  return block_sums_reference(rows, x, begin, end);
}
void compare_row(const CompareRow& row, const CompareLimits& limits, std::uint64_t* weak,
                 std::uint64_t* strong) {
  compare_row_reference(row, limits, weak, strong);
}
void learn_row(const LearnRow& row) {
  learn_row_reference(row);
}
#else

using D16 = hn::CappedTag<std::int16_t, 16>;
using D32 = hn::RepartitionToWide<D16>;

template <class D>
HWY_INLINE hn::Vec<D> load(D d, const std::uint8_t* p) {
  return hn::PromoteTo(d, hn::LoadU(hn::Rebind<std::uint8_t, D>(), p));
}
template <class D>
HWY_INLINE void store(D, hn::Vec<D> v, std::uint8_t* p) {
  const hn::Rebind<std::uint8_t, D> half;
  hn::StoreU(hn::DemoteTo(half, v), half, p);
}

// Sum of products into 32 bits.
struct Sum {
  hn::Vec<D32> low, high;
  HWY_INLINE Sum() : low(hn::Zero(D32())), high(hn::Zero(D32())) {}
  HWY_INLINE void add(hn::Vec<D16> a, hn::Vec<D16> b) {
    low = hn::ReorderWidenMulAccumulate(D32(), a, b, low, high);
  }
  HWY_INLINE std::int32_t total() const { return hn::GetLane(hn::SumOfLanes(D32(), hn::Add(low, high))); }
};

template <class V>
HWY_INLINE V length(V gx, V gy) {
  const auto a = hn::Abs(gx), b = hn::Abs(gy);
  return hn::Add(hn::Max(a, b), hn::ShiftRight<1>(hn::Min(a, b)));
}

BlockSums block_sums(const BlockRows& rows, int x0, int begin, int end) {
  const D16 d;
  const int lanes = static_cast<int>(hn::Lanes(d));
  Sum xx, xy, yy, xe, ye, ee, n, ge, gg;
  const auto one = hn::Set(d, 1), zero = hn::Zero(d);
  const auto largest = hn::Set(d, BlockSums::kLargest + 1);
  const auto calm = hn::Set(d, static_cast<std::int16_t>(rows.quiet_from - 1));
  for (int x = x0; x < x0 + kBackgroundBlock; x += lanes) {
    const auto column = hn::Iota(d, static_cast<std::int16_t>(x));
    const auto inside = hn::And(hn::Gt(column, hn::Set(d, static_cast<std::int16_t>(begin - 1))),
                                hn::Lt(column, hn::Set(d, static_cast<std::int16_t>(end))));
    for (int y = rows.first; y < rows.end; y += rows.step) {
      const std::uint8_t* m = rows.background.row(y) + x;
      const auto e = hn::Sub(load(d, rows.frame.row(y) + x), load(d, m));
      const auto gx = hn::Sub(load(d, m + 1), load(d, m - 1));
      const auto gy = hn::Sub(load(d, m + rows.background.stride), load(d, m - rows.background.stride));
      const auto use =
          hn::And(inside, hn::And(hn::Gt(load(d, rows.age.row(y) + x), zero), hn::Lt(hn::Abs(e), largest)));
      const auto ue = hn::IfThenElseZero(use, e);
      const auto ux = hn::IfThenElseZero(use, gx), uy = hn::IfThenElseZero(use, gy);
      xx.add(ux, ux), xy.add(ux, uy), yy.add(uy, uy), xe.add(ux, ue), ye.add(uy, ue), ee.add(ue, ue);
      n.add(hn::IfThenElse(use, one, zero), one);
      const auto quiet = hn::And(use, hn::Gt(load(d, rows.quiet.row(y) + x), calm));
      const auto g = hn::IfThenElseZero(quiet, length(gx, gy));
      ge.add(g, hn::Abs(ue)), gg.add(g, g);
    }
  }
  return {xx.total(), xy.total(), yy.total(), xe.total(), ye.total(),
          ee.total(), n.total(),  ge.total(), gg.total()};
}

// The mask of the lanes from x on, and back. Eight lanes are a byte of the row; x is a multiple of the lanes.
template <class D>
HWY_INLINE hn::Mask<D> bits_at(D d, const std::uint64_t* row, int x) {
  return hn::LoadMaskBits(d, reinterpret_cast<const std::uint8_t*>(row) + x / 8);
}
template <class D>
HWY_INLINE void put_bits(D d, hn::Mask<D> mask, std::uint64_t* row, int x) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(d, mask, bytes);
  std::memcpy(reinterpret_cast<std::uint8_t*>(row) + x / 8, bytes, hn::Lanes(d) / 8);
}

// Calls run(vectors, x) along a row: 32 samples at a time where the processor has such vectors, and the rest by 16 or
// what there is. Planes are padded for that (background_kernels.h).
template <class Run>
HWY_INLINE void along_row(int width, Run&& run) {
  const hn::CappedTag<std::int16_t, 32> wide;
  const D16 d;
  const int many = static_cast<int>(hn::Lanes(wide)), lanes = static_cast<int>(hn::Lanes(d));
  const int padded = (width + lanes - 1) / lanes * lanes;
  int x = 0;
  for (; x + many <= padded; x += many) run(wide, x);
  for (; x < padded; x += lanes) run(d, x);
}

void compare_row(const CompareRow& row, const CompareLimits& limits, std::uint64_t* weak,
                 std::uint64_t* strong) {
  if (hn::Lanes(D16()) < 8) return compare_row_reference(row, limits, weak, strong);
  alignas(16) std::uint8_t table_bytes[16];
  std::memcpy(table_bytes, limits.noise.data(), 16);
  along_row(row.width, [&](auto d, int x) HWY_ATTR {
    const hn::Repartition<std::uint8_t, decltype(d)> d8;
    const auto table = hn::LoadDup128(d8, table_bytes);
    const auto set = [&](int v) { return hn::Set(d, static_cast<std::int16_t>(v)); };
    const auto weak_sigmas = set(limits.weak_sigmas), strong_sigmas = set(limits.strong_sigmas);
    const auto weak_least = set(limits.weak_least), strong_least = set(limits.strong_least);
    const auto young = set(limits.young), ticks = set(row.ticks), most = set(255);
    const auto sure = hn::Eq(set(limits.registered), hn::Zero(d));
    const auto m = load(d, row.background + x);
    const auto e = hn::ShiftLeft<4>(hn::Abs(hn::Sub(load(d, row.frame + x), m)));
    const auto gx = hn::Sub(load(d, row.background + x + 1), load(d, row.background + x - 1));
    const auto gy = hn::Sub(load(d, row.below + x), load(d, row.above + x));
    // |g| * tolerance: half of the doubled gradient's length times sixteenths of a pixel.
    const auto edge = hn::ShiftRight<1>(hn::Mul(length(gx, gy), load(d, row.tolerance + x)));
    // The class in the low byte of every lane, 0x80 in the high byte: looked up as 0.
    const auto index = hn::Or(hn::ShiftRight<4>(m), set(-32768));
    const auto noise = hn::And(hn::BitCast(d, hn::TableLookupBytesOr0(table, hn::BitCast(d8, index))), most);
    const auto spread = load(d, row.spread + x);
    const auto s = hn::Max(noise, hn::Add(spread, hn::ShiftRight<2>(spread)));
    const auto weak_limit = hn::Max(weak_least, hn::Mul(s, weak_sigmas));
    const auto strong_limit = hn::Add(hn::Max(strong_least, hn::Mul(s, strong_sigmas)), edge);
    const auto moved = bits_at(d, row.moved, x);
    const auto unsure = hn::Lt(load(d, row.age + x), young);
    auto is_weak = hn::Or(hn::Gt(e, hn::Add(weak_limit, edge)), hn::And(moved, hn::Gt(e, weak_limit)));
    auto is_strong = hn::Gt(e, strong_limit);
    is_weak = hn::Or(hn::AndNot(unsure, is_weak), hn::And(unsure, moved));
    is_strong =
        hn::Or(hn::AndNot(unsure, is_strong), hn::And(hn::And(unsure, moved), hn::Or(sure, hn::Gt(e, edge))));
    put_bits(d, is_weak, weak, x);
    put_bits(d, is_strong, strong, x);
    store(d, hn::IfThenZeroElse(moved, hn::Min(hn::Add(load(d, row.quiet + x), ticks), most)), row.quiet + x);
  });
}

void learn_row(const LearnRow& row) {
  if (hn::Lanes(D16()) < 8) return learn_row_reference(row);
  alignas(16) std::uint8_t young_bytes[16], old_bytes[16];
  std::memcpy(young_bytes, kYoungRate.data(), 16);
  std::memcpy(old_bytes, kOldRate.data(), 16);
  along_row(row.width, [&](auto d, int x) HWY_ATTR {
    const hn::RebindToUnsigned<decltype(d)> du;
    const hn::Repartition<std::uint8_t, decltype(d)> d8;
    const auto young_table = hn::LoadDup128(d8, young_bytes), old_table = hn::LoadDup128(d8, old_bytes);
    const auto set = [&](int v) { return hn::Set(d, static_cast<std::int16_t>(v)); };
    const auto most = set(255), one = set(1), sixteen = set(16), high = set(-32768), phase = set(row.phase),
               tick = set(row.tick);
    const auto white = hn::Set(du, 255 << 8);
    const auto look_up = [&](auto table, auto index) {
      return hn::And(hn::BitCast(d, hn::TableLookupBytesOr0(table, hn::BitCast(d8, hn::Or(index, high)))),
                     most);
    };
    const auto f = load(d, row.frame + x), m = load(d, row.background + x);
    const auto age = load(d, row.age + x), quiet = load(d, row.quiet + x), spread = load(d, row.spread + x);
    const auto mean = hn::LoadU(du, row.mean + x);
    const auto valid = bits_at(d, row.valid, x);
    const auto unknown = hn::Eq(age, hn::Zero(d));
    const auto take = hn::And(valid, hn::Or(unknown, bits_at(d, row.absorb, x)));
    const auto follow = hn::AndNot(hn::Or(take, bits_at(d, row.keep, x)), valid);

    const auto e = hn::Sub(f, m), size = hn::Abs(e);
    const auto rate = hn::IfThenElse(hn::Lt(age, sixteen), look_up(young_table, hn::Min(age, set(15))),
                                     look_up(old_table, hn::ShiftRight<4>(age)));
    const auto step = hn::BitCast(du, hn::Mul(size, rate));  // below 2^16: the product's low half, unsigned
    const auto rising = hn::RebindMask(du, hn::Gt(e, hn::Zero(d)));
    auto next =
        hn::IfThenElse(rising, hn::Min(hn::SaturatedAdd(mean, step), white), hn::SaturatedSub(mean, step));
    const auto target = hn::Min(hn::ShiftLeft<4>(size), most);
    const auto grow = hn::Max(hn::Sub(target, spread), hn::Zero(d)),
               shrink = hn::Max(hn::Sub(spread, target), hn::Zero(d));
    auto next_spread = hn::Sub(hn::Add(spread, hn::ShiftRight<4>(hn::Add(grow, phase))),
                               hn::ShiftRight<4>(hn::Add(shrink, phase)));
    auto next_age = hn::Min(hn::Add(age, one), most);

    const auto fresh = hn::ShiftLeft<8>(hn::BitCast(du, load(d, row.taken + x)));
    const auto rested = hn::Mul(quiet, tick);  // frames
    const auto young = hn::IfThenElse(unknown, one, hn::Max(set(2), hn::ShiftRight<1>(hn::Min(age, rested))));
    next = hn::IfThenElse(hn::RebindMask(du, take), fresh,
                          hn::IfThenElse(hn::RebindMask(du, follow), next, mean));
    next_spread = hn::IfThenElse(take, sixteen, hn::IfThenElse(follow, next_spread, spread));
    next_age = hn::IfThenElse(take, young, hn::IfThenElse(follow, next_age, age));
    hn::StoreU(next, du, row.mean + x);
    store(d, next_spread, row.spread + x);
    store(d, next_age, row.age + x);
  });
}
#endif

void round_row(const std::uint16_t* mean, int width, std::uint8_t* out) {
  for (int x = 0; x < width; ++x) {
    const unsigned v = mean[x] < 65280 ? mean[x] : 65280;
    out[x] = static_cast<std::uint8_t>((v + 128) >> 8);
  }
}

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(block_sums);
HWY_EXPORT(compare_row);
HWY_EXPORT(learn_row);
HWY_EXPORT(round_row);

BlockSums block_sums(const BlockRows& rows, int x, int begin, int end) {
  return HWY_DYNAMIC_DISPATCH(block_sums)(rows, x, begin, end);
}
void compare_row(const CompareRow& row, const CompareLimits& limits, std::uint64_t* weak,
                 std::uint64_t* strong) {
  HWY_DYNAMIC_DISPATCH(compare_row)(row, limits, weak, strong);
}
void learn_row(const LearnRow& row) {
  HWY_DYNAMIC_DISPATCH(learn_row)(row);
}
void round_row(const std::uint16_t* mean, int width, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(round_row)(mean, width, out);
}

namespace {

void set_bit(std::uint64_t* row, int x, bool on) {
  const std::uint64_t mask = std::uint64_t{1} << (x % 64);
  row[x / 64] = on ? row[x / 64] | mask : row[x / 64] & ~mask;
}

}  // namespace

BlockSums block_sums_reference(const BlockRows& rows, int x0, int begin, int end) {
  BlockSums s;
  for (int y = rows.first; y < rows.end; y += rows.step)
    for (int x = std::max(x0, begin); x < std::min(x0 + kBackgroundBlock, end); ++x) {
      const int e = rows.frame.at(x, y) - rows.background.at(x, y);
      if (rows.age.at(x, y) < 1 || std::abs(e) > BlockSums::kLargest) continue;
      const int gx = rows.background.at(x + 1, y) - rows.background.at(x - 1, y);
      const int gy = rows.background.at(x, y + 1) - rows.background.at(x, y - 1);
      s.xx += gx * gx, s.xy += gx * gy, s.yy += gy * gy, s.xe += gx * e, s.ye += gy * e, s.ee += e * e;
      ++s.n;
      if (rows.quiet.at(x, y) < rows.quiet_from) continue;
      const int g = gradient_length(gx, gy);
      s.ge += g * std::abs(e), s.gg += g * g;
    }
  return s;
}

void compare_row_reference(const CompareRow& row, const CompareLimits& limits, std::uint64_t* weak,
                           std::uint64_t* strong) {
  for (int x = 0; x < row.width; ++x) {
    const int m = row.background[x], e = std::abs(row.frame[x] - m) * 16;
    const int g = gradient_length(row.background[x + 1] - row.background[x - 1], row.below[x] - row.above[x]);
    const int edge = g * row.tolerance[x] / 2;
    const int s = std::max<int>(limits.noise[m / 16], row.spread[x] + row.spread[x] / 4);
    const int weak_limit = std::max(limits.weak_least, limits.weak_sigmas * s);
    const int strong_limit = std::max(limits.strong_least, limits.strong_sigmas * s);
    const bool moved = bit_at(row.moved, x);
    const bool unsure = row.age[x] < limits.young;
    set_bit(weak, x, unsure ? moved : e > weak_limit + edge || (moved && e > weak_limit));
    set_bit(strong, x, unsure ? moved && (!limits.registered || e > edge) : e > strong_limit + edge);
    row.quiet[x] = static_cast<std::uint8_t>(moved ? 0 : std::min(row.quiet[x] + row.ticks, 255));
  }
}

void learn_row_reference(const LearnRow& row) {
  for (int x = 0; x < row.width; ++x) {
    if (!bit_at(row.valid, x)) continue;
    const int f = row.frame[x], age = row.age[x];
    if (age == 0 || bit_at(row.absorb, x)) {
      row.mean[x] = static_cast<std::uint16_t>(row.taken[x] << 8);
      row.spread[x] = 16;
      row.age[x] =
          static_cast<std::uint8_t>(age == 0 ? 1 : std::max(2, std::min(age, row.quiet[x] * row.tick) / 2));
      continue;
    }
    if (bit_at(row.keep, x)) continue;
    const int e = f - row.background[x], size = std::abs(e);
    const int rate = age < 16 ? kYoungRate[age] : kOldRate[age / 16];
    row.mean[x] = static_cast<std::uint16_t>(
        std::clamp(e > 0 ? row.mean[x] + size * rate : row.mean[x] - size * rate, 0, 255 << 8));
    const int target = std::min(size * 16, 255), spread = row.spread[x];
    const int grow = std::max(target - spread, 0), shrink = std::max(spread - target, 0);
    row.spread[x] = static_cast<std::uint8_t>(spread + (grow + row.phase) / 16 - (shrink + row.phase) / 16);
    row.age[x] = static_cast<std::uint8_t>(std::min(age + 1, 255));
  }
}

}  // namespace cerberus::vision
#endif
