// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/blend_kernels.h"

#include <algorithm>
#include <bit>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "overlay/blend_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::overlay::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#if HWY_TARGET == HWY_SCALAR

bool weigh_rows(const WeightedRow& row, std::int32_t* value, std::int32_t* rest) {
  const int step = row.pairs ? 2 : 1;
  bool any = false;
  for (int i = 0; i < row.samples; ++i) {
    weigh_sample(row, row.top + i * step, row.bottom ? row.bottom + i * step : nullptr, step, value[i],
                 rest[i]);
    any = any || rest[i] != row.full;
  }
  return any;
}

void mix_samples(const std::int32_t* value, const std::int32_t* rest, int shift, int samples,
                 std::uint8_t* to) {
  for (int x = 0; x < samples; ++x) to[x] = mix_sample(value[x], rest[x], shift, to[x]);
}

void blend_packed_pixels(const std::uint32_t* from, const PackedLayout& layout, int pixels,
                         std::uint8_t* to) {
  for (int x = 0; x < pixels; ++x) blend_packed_pixel(from[x], layout, to + 4 * x);
}

#else

// Two channels of words, eight bits each, in the halves of a word: blue and red, green and alpha.
template <class V>
struct Channels {
  V blue_red, green_alpha;
};

template <class D>
HWY_INLINE Channels<hn::Vec<D>> split(D d, hn::Vec<D> words) {
  const auto low = hn::Set(d, 0x00ff00ffu);
  return {hn::And(words, low), hn::And(hn::ShiftRight<8>(words), low)};
}

// Sums of neighbours: half as many words.
template <class D>
HWY_INLINE hn::Vec<hn::Half<D>> pair_sums(D, hn::Vec<D> sums) {
  const hn::RepartitionToWide<D> wide;
  const auto pairs = hn::BitCast(wide, sums);
  return hn::TruncateTo(hn::Half<D>(), hn::Add(pairs, hn::ShiftRight<32>(pairs)));
}

template <class D>
HWY_INLINE void store_weighed(D d, const WeightedRow& row, Channels<hn::Vec<D>> sums, std::int32_t* value,
                              std::int32_t* rest) {
  const hn::RebindToSigned<D> s;
  const auto low = hn::Set(d, 0xffffu);
  const auto red = hn::BitCast(s, hn::ShiftRight<16>(sums.blue_red)),
             blue = hn::BitCast(s, hn::And(sums.blue_red, low));
  const auto alpha = hn::BitCast(s, hn::ShiftRight<16>(sums.green_alpha)),
             green = hn::BitCast(s, hn::And(sums.green_alpha, low));
  const auto colors = hn::Add(hn::Mul(red, hn::Set(s, row.red)), hn::Mul(green, hn::Set(s, row.green)));
  const auto others = hn::Add(hn::Mul(blue, hn::Set(s, row.blue)), hn::Mul(alpha, hn::Set(s, row.alpha)));
  hn::StoreU(hn::Add(colors, others), s, value);
  hn::StoreU(hn::Sub(hn::Set(s, row.full), alpha), s, rest);
}

// Processes the words from x on that fill whole vectors; returns their end.
template <class D>
HWY_INLINE int weigh_vectors(D d, const WeightedRow& row, int x, int words, std::int32_t* value,
                             std::int32_t* rest) {
  const hn::Half<D> half;
  const int lanes = static_cast<int>(hn::Lanes(d));
  for (; x + lanes <= words; x += lanes) {
    auto sums = split(d, hn::LoadU(d, row.top + x));
    if (row.bottom) {
      const auto more = split(d, hn::LoadU(d, row.bottom + x));
      sums = {hn::Add(sums.blue_red, more.blue_red), hn::Add(sums.green_alpha, more.green_alpha)};
    }
    if (row.pairs) {
      const Channels<hn::Vec<decltype(half)>> halved{pair_sums(d, sums.blue_red),
                                                     pair_sums(d, sums.green_alpha)};
      store_weighed(half, row, halved, value + x / 2, rest + x / 2);
    } else {
      store_weighed(d, row, sums, value + x, rest + x);
    }
  }
  return x;
}

bool weigh_rows(const WeightedRow& row, std::int32_t* value, std::int32_t* rest) {
  const int words = row.pairs ? 2 * row.samples : row.samples, step = row.pairs ? 2 : 1;
  std::uint32_t seen = 0;
  for (const std::uint32_t* from : {row.top, row.bottom})
    for (int i = 0; from && i < words; ++i) seen |= from[i];
  if (seen == 0) return false;
  // The sides of boxes are about twelve pixels wide: vectors of eight and of four leave few words over.
  int x = weigh_vectors(hn::CappedTag<std::uint32_t, 8>(), row, 0, words, value, rest);
  x = weigh_vectors(hn::CappedTag<std::uint32_t, 4>(), row, x, words, value, rest);
  for (; x < words; x += step)
    weigh_sample(row, row.top + x, row.bottom ? row.bottom + x : nullptr, step, value[x / step],
                 rest[x / step]);
  return true;
}

template <class D>
HWY_INLINE int mix_vectors(D d, const std::int32_t* value, const std::int32_t* rest, int shift, int x,
                           int samples, std::uint8_t* to) {
  const hn::Rebind<std::uint8_t, D> bytes;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto half = hn::Set(d, 32768 << shift);
  for (; x + lanes <= samples; x += lanes) {
    const auto kept = hn::Mul(hn::PromoteTo(d, hn::LoadU(bytes, to + x)), hn::LoadU(d, rest + x));
    const auto scaled = hn::Add(hn::Mul(kept, hn::Set(d, 257)), hn::ShiftRight<8>(kept));
    const auto sum = hn::Add(hn::Add(hn::LoadU(d, value + x), scaled), half);
    hn::StoreU(hn::DemoteTo(bytes, hn::ShiftRightSame(sum, 16 + shift)), bytes, to + x);
  }
  return x;
}

void mix_samples(const std::int32_t* value, const std::int32_t* rest, int shift, int samples,
                 std::uint8_t* to) {
  int x = mix_vectors(hn::CappedTag<std::int32_t, 8>(), value, rest, shift, 0, samples, to);
  x = mix_vectors(hn::CappedTag<std::int32_t, 4>(), value, rest, shift, x, samples, to);
  for (; x < samples; ++x) to[x] = mix_sample(value[x], rest[x], shift, to[x]);
}

void blend_packed_pixels(const std::uint32_t* from, const PackedLayout& layout, int pixels,
                         std::uint8_t* to) {
  const hn::ScalableTag<std::uint8_t> d;
  const hn::Repartition<std::uint16_t, decltype(d)> wide;
  const hn::Repartition<std::uint32_t, decltype(d)> words;
  constexpr std::uint8_t kAlpha = std::endian::native == std::endian::little ? 3 : 0;
  std::uint32_t color = 0, alpha = 0;  // byte numbers within the four of a pixel
  std::uint8_t colors[4], alphas[4];
  for (int i = 0; i < 4; ++i) {
    colors[i] = layout.color[i];
    alphas[i] = layout.color[i] == PackedLayout::kKept ? PackedLayout::kKept : kAlpha;
  }
  std::memcpy(&color, colors, 4);
  std::memcpy(&alpha, alphas, 4);
  // The table of 16 bytes: that of a pixel, four times, each four bytes on; what is kept stays 0x80 or more.
  const auto within = hn::And(hn::Iota(words, 0), hn::Set(words, 3u));
  const auto steps = hn::Mul(within, hn::Set(words, 0x04040404u));
  const auto color_table = hn::BitCast(d, hn::Add(hn::Set(words, color), steps)),
             alpha_table = hn::BitCast(d, hn::Add(hn::Set(words, alpha), steps));
  const auto low = hn::Set(wide, std::uint16_t{255}), half = hn::Set(wide, std::uint16_t{128});
  const auto divided = [&](auto product) {  // by 255, rounded
    const auto sum = hn::Add(product, half);
    return hn::ShiftRight<8>(hn::Add(sum, hn::ShiftRight<8>(sum)));
  };
  const int lanes = static_cast<int>(hn::Lanes(words));
  int x = 0;
  for (; x + lanes <= pixels; x += lanes) {
    const auto drawn = hn::LoadU(words, from + x);
    if (hn::AllTrue(words, hn::Eq(drawn, hn::Zero(words)))) continue;
    const auto source = hn::BitCast(d, drawn);
    const auto rest = hn::BitCast(wide, hn::Not(hn::TableLookupBytesOr0(source, alpha_table)));
    const auto before = hn::BitCast(wide, hn::LoadU(d, to + 4 * x));
    const auto even = divided(hn::Mul(hn::And(before, low), hn::And(rest, low)));
    const auto odd = divided(hn::Mul(hn::ShiftRight<8>(before), hn::ShiftRight<8>(rest)));
    const auto kept = hn::BitCast(d, hn::Or(even, hn::ShiftLeft<8>(odd)));
    hn::StoreU(hn::SaturatedAdd(kept, hn::TableLookupBytesOr0(source, color_table)), d, to + 4 * x);
  }
  for (; x < pixels; ++x) blend_packed_pixel(from[x], layout, to + 4 * x);
}

#endif

}  // namespace cerberus::overlay::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::overlay {

HWY_EXPORT(weigh_rows);
HWY_EXPORT(mix_samples);
HWY_EXPORT(blend_packed_pixels);

void weigh_sample(const WeightedRow& row, const std::uint32_t* top, const std::uint32_t* bottom, int count,
                  std::int32_t& value, std::int32_t& rest) {
  std::int32_t r = 0, g = 0, b = 0, a = 0;
  for (const std::uint32_t* from : {top, bottom})
    for (int i = 0; from && i < count; ++i) {
      const std::uint32_t p = from[i];
      r += p >> 16 & 255, g += p >> 8 & 255, b += p & 255, a += p >> 24;
    }
  value = row.red * r + row.green * g + row.blue * b + row.alpha * a;
  rest = row.full - a;
}

std::uint8_t mix_sample(std::int32_t value, std::int32_t rest, int shift, std::uint8_t sample) {
  const std::int32_t kept = sample * rest;
  const std::int32_t sum = value + kept * 257 + (kept >> 8) + (32768 << shift);
  return static_cast<std::uint8_t>(std::clamp(sum >> (16 + shift), 0, 255));
}

void blend_packed_pixel(std::uint32_t word, const PackedLayout& layout, std::uint8_t* to) {
  if (word == 0) return;
  std::uint8_t drawn[4];
  std::memcpy(drawn, &word, 4);
  for (int i = 0; i < 4; ++i) {
    if (layout.color[i] == PackedLayout::kKept) continue;
    const int sum = to[i] * static_cast<int>(255 - (word >> 24)) + 128;
    to[i] = static_cast<std::uint8_t>(std::min(drawn[layout.color[i]] + ((sum + (sum >> 8)) >> 8), 255));
  }
}

bool weigh(const WeightedRow& row, std::int32_t* value, std::int32_t* rest) {
  return HWY_DYNAMIC_DISPATCH(weigh_rows)(row, value, rest);
}

void mix(const std::int32_t* value, const std::int32_t* rest, int shift, int samples, std::uint8_t* to) {
  HWY_DYNAMIC_DISPATCH(mix_samples)(value, rest, shift, samples, to);
}

void blend_packed(const std::uint32_t* from, const PackedLayout& layout, int pixels, std::uint8_t* to) {
  HWY_DYNAMIC_DISPATCH(blend_packed_pixels)(from, layout, pixels, to);
}

}  // namespace cerberus::overlay
#endif
