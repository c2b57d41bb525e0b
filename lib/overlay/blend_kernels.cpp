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

// A row of samples: the rows of the drawing that it stands for.
struct Rows {
  const std::uint32_t* top = nullptr;
  const std::uint32_t* bottom = nullptr;  // null: no second row
};

void look_ahead(const std::uint8_t* row, std::ptrdiff_t bytes) {
  constexpr std::ptrdiff_t kLine = 64;
  for (std::ptrdiff_t at = 0; at < bytes; at += kLine) __builtin_prefetch(row + at, 1);
  __builtin_prefetch(row + bytes - 1, 1);
}

#if HWY_TARGET == HWY_SCALAR

int blend_row(const Rows&, const PlaneGroup&, int from, int, int, int) {
  return from;
}

int blend_packed_row(const std::uint32_t*, const PackedLayout&, int, std::uint8_t*) {
  return 0;
}

#else

// The sides of boxes are about twelve pixels wide: vectors of eight and of four words leave few over.
constexpr int kMostLanes = 8, kFewLanes = 4;

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

// Blends the sums into samples side by side of all planes.
template <class D>
HWY_INLINE void mix(D d, Channels<hn::Vec<D>> sums, const PlaneGroup& group, int u, int v) {
  const hn::RebindToSigned<D> s;
  const hn::Rebind<std::uint8_t, D> bytes;
  const auto low = hn::Set(d, 0xffffu);
  const auto red = hn::BitCast(s, hn::ShiftRight<16>(sums.blue_red)),
             blue = hn::BitCast(s, hn::And(sums.blue_red, low)),
             alpha = hn::BitCast(s, hn::ShiftRight<16>(sums.green_alpha)),
             green = hn::BitCast(s, hn::And(sums.green_alpha, low));
  const auto rest = hn::Sub(hn::Set(s, group.full()), alpha);
  const auto half = hn::Set(s, 32768 << group.shift());
  for (int i = 0; i < group.count; ++i) {
    const WeightedPlane& plane = group.planes[i];
    const auto colors = hn::Add(hn::Mul(red, hn::Set(s, plane.red)), hn::Mul(green, hn::Set(s, plane.green)));
    const auto others =
        hn::Add(hn::Mul(blue, hn::Set(s, plane.blue)), hn::Mul(alpha, hn::Set(s, plane.alpha)));
    const auto value = hn::Add(hn::Add(colors, others), half);
    std::uint8_t* to = plane.data + v * plane.stride + static_cast<std::ptrdiff_t>(u) * plane.step;
    const auto mixed = [&](auto samples) {
      const auto kept = hn::Mul(hn::PromoteTo(s, samples), rest);
      const auto sum =
          hn::Add(value, hn::Add(hn::Add(hn::ShiftLeft<8>(kept), kept), hn::ShiftRight<8>(kept)));
      return hn::DemoteTo(bytes, hn::ShiftRightSame(sum, 16 + group.shift()));
    };
    if (plane.step == 1) {
      hn::StoreU(mixed(hn::LoadU(bytes, to)), bytes, to);
    } else {
      std::uint8_t side_by_side[kMostLanes];
      const int lanes = static_cast<int>(hn::Lanes(d));
      for (int k = 0; k < lanes; ++k) side_by_side[k] = to[k * plane.step];
      hn::StoreU(mixed(hn::LoadU(bytes, side_by_side)), bytes, side_by_side);
      for (int k = 0; k < lanes; ++k) to[k * plane.step] = side_by_side[k];
    }
  }
}

template <class D>
HWY_INLINE int blend_vectors(D d, const Rows& rows, const PlaneGroup& group, int from, int words, int u,
                             int v) {
  const hn::Half<D> half;
  const int lanes = static_cast<int>(hn::Lanes(d)), samples = lanes >> group.shift_x;
  for (; from + lanes <= words; from += lanes, u += samples) {
    const auto top = hn::LoadU(d, rows.top + from);
    const auto bottom = rows.bottom ? hn::LoadU(d, rows.bottom + from) : hn::Zero(d);
    if (hn::AllTrue(d, hn::Eq(hn::Or(top, bottom), hn::Zero(d)))) continue;
    const auto upper = split(d, top), lower = split(d, bottom);
    const Channels<hn::Vec<D>> sums{hn::Add(upper.blue_red, lower.blue_red),
                                    hn::Add(upper.green_alpha, lower.green_alpha)};
    if (group.shift_x == 1)
      mix(half, {pair_sums(d, sums.blue_red), pair_sums(d, sums.green_alpha)}, group, u, v);
    else
      mix(d, sums, group, u, v);
  }
  return from;
}

// Blends the words from..words that fill whole vectors; u: the sample of the first. Returns their end.
int blend_row(const Rows& rows, const PlaneGroup& group, int from, int words, int u, int v) {
  const int first = from;
  from = blend_vectors(hn::CappedTag<std::uint32_t, kMostLanes>(), rows, group, from, words, u, v);
  u += (from - first) >> group.shift_x;
  return blend_vectors(hn::CappedTag<std::uint32_t, kFewLanes>(), rows, group, from, words, u, v);
}

template <class D>
HWY_INLINE int blend_packed_vectors(D words, const std::uint32_t* from, const PackedLayout& layout, int x,
                                    int pixels, std::uint8_t* to) {
  const hn::Repartition<std::uint8_t, D> d;
  const hn::Repartition<std::uint16_t, D> wide;
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
  return x;
}

HWY_INLINE int blend_packed_row(const std::uint32_t* from, const PackedLayout& layout, int pixels,
                                std::uint8_t* to) {
  const int x = blend_packed_vectors(hn::CappedTag<std::uint32_t, kMostLanes>(), from, layout, 0, pixels, to);
  return blend_packed_vectors(hn::CappedTag<std::uint32_t, kFewLanes>(), from, layout, x, pixels, to);
}

#endif

void blend_all_planes(vision::View<const std::uint32_t> drawing, int x, int y, const PlaneGroup& group) {
  const int side = 1 << group.shift_x, bottom = y + drawing.height, width = drawing.width;
  const int left = x & (side - 1);  // column of the drawing's first pixel within its sample
  for (int v = y >> group.shift_y; v << group.shift_y < bottom; ++v) {
    if ((v + kRowsAhead) << group.shift_y < bottom)
      for (int i = 0; i < group.count; ++i) {
        const WeightedPlane& plane = group.planes[i];
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(x >> group.shift_x) * plane.step;
        look_ahead(plane.data + (v + kRowsAhead) * plane.stride + at,
                   static_cast<std::ptrdiff_t>(width >> group.shift_x) * plane.step);
      }
    const int first = std::max(v << group.shift_y, y) - y,
              end = std::min((v + 1) << group.shift_y, bottom) - y;
    const Rows rows{drawing.row(first), end - first > 1 ? drawing.row(first + 1) : nullptr};
    int u = x >> group.shift_x, at = 0;
    const auto blend_one = [&](int stop) {
      blend_sample(rows.top + at, rows.bottom ? rows.bottom + at : nullptr, stop - at, group, u++, v);
      at = stop;
    };
    if (left > 0) blend_one(std::min(side - left, width));
    if (group.shift_x <= 1) {
      const int stop = blend_row(rows, group, at, width, u, v);
      u += (stop - at) >> group.shift_x;
      at = stop;
    }
    while (at < width) blend_one(std::min(at + side, width));
  }
}

void blend_all_packed(vision::View<const std::uint32_t> drawing, const PackedLayout& layout, std::uint8_t* to,
                      std::ptrdiff_t stride) {
  for (int y = 0; y < drawing.height; ++y, to += stride) {
    if (y + kRowsAhead < drawing.height)
      look_ahead(to + kRowsAhead * stride, 4 * static_cast<std::ptrdiff_t>(drawing.width));
    const std::uint32_t* from = drawing.row(y);
    for (int x = blend_packed_row(from, layout, drawing.width, to); x < drawing.width; ++x)
      blend_packed_pixel(from[x], layout, to + 4 * static_cast<std::ptrdiff_t>(x));
  }
}

}  // namespace cerberus::overlay::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::overlay {

HWY_EXPORT(blend_all_planes);
HWY_EXPORT(blend_all_packed);

void blend_sample(const std::uint32_t* top, const std::uint32_t* bottom, int count, const PlaneGroup& group,
                  int u, int v) {
  std::int32_t r = 0, g = 0, b = 0, a = 0;
  for (const std::uint32_t* from : {top, bottom})
    for (int i = 0; from && i < count; ++i) {
      const std::uint32_t p = from[i];
      r += p >> 16 & 255, g += p >> 8 & 255, b += p & 255, a += p >> 24;
    }
  if (a == 0) return;
  for (int i = 0; i < group.count; ++i) {
    const WeightedPlane& plane = group.planes[i];
    std::uint8_t& sample = plane.data[v * plane.stride + static_cast<std::ptrdiff_t>(u) * plane.step];
    const std::int32_t value = plane.red * r + plane.green * g + plane.blue * b + plane.alpha * a;
    const std::int32_t kept = sample * (group.full() - a);
    const std::int32_t sum = value + kept * 257 + (kept >> 8) + (32768 << group.shift());
    sample = static_cast<std::uint8_t>(std::clamp(sum >> (16 + group.shift()), 0, 255));
  }
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

void blend_planes(vision::View<const std::uint32_t> drawing, int x, int y, const PlaneGroup& group) {
  HWY_DYNAMIC_DISPATCH(blend_all_planes)(drawing, x, y, group);
}

void blend_packed(vision::View<const std::uint32_t> drawing, const PackedLayout& layout, std::uint8_t* to,
                  std::ptrdiff_t stride) {
  HWY_DYNAMIC_DISPATCH(blend_all_packed)(drawing, layout, to, stride);
}

}  // namespace cerberus::overlay
#endif
