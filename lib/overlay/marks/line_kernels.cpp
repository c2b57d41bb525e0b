// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/line_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "overlay/marks/line_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::overlay::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Drawings are tens of pixels wide.
using Floats = hn::CappedTag<float, 16>;
using V = hn::Vec<Floats>;
constexpr Floats f;
constexpr hn::RebindToSigned<Floats> s;
constexpr hn::RebindToUnsigned<Floats> words;

HWY_INLINE V share(V depth) {
  return hn::Min(hn::Max(hn::Add(depth, hn::Set(f, 0.5f)), hn::Zero(f)), hn::Set(f, 1.0f));
}

// Shares of 0 to 1 as bytes, at a place of the words.
template <int kShift>
HWY_INLINE hn::Vec<decltype(words)> bytes(V shares) {
  const auto rounded = hn::ConvertTo(s, hn::MulAdd(shares, hn::Set(f, 255.0f), hn::Set(f, 0.5f)));
  return hn::ShiftLeft<kShift>(hn::BitCast(words, rounded));
}

// Words of a colour times `ink`, with another alpha.
HWY_INLINE hn::Vec<decltype(words)> words_of(V alpha, V ink, const Premultiplied& color) {
  const auto a = bytes<24>(alpha), r = bytes<16>(hn::Mul(ink, hn::Set(f, color.r))),
             g = bytes<8>(hn::Mul(ink, hn::Set(f, color.g))), b = bytes<0>(hn::Mul(ink, hn::Set(f, color.b)));
  return hn::Or(hn::Or(a, r), hn::Or(g, b));
}

// Writes the first `count` of the words.
HWY_INLINE void store(hn::Vec<decltype(words)> v, int count, std::uint32_t* to) {
  if (count >= static_cast<int>(hn::Lanes(words))) return hn::StoreU(v, words, to);
  HWY_ALIGN std::uint32_t all[16];
  hn::Store(v, words, all);
  std::copy_n(all, count, to);
}

// Arc tangent of 0 to 1: Abramowitz and Stegun, Handbook of Mathematical Functions, 4.4.49; error at most 1e-5.
HWY_INLINE V arc_tangent(V z) {
  const V square = hn::Mul(z, z);
  V sum = hn::Set(f, 0.0208351f);
  for (const float c : {-0.0851330f, 0.1801410f, -0.3302995f, 0.9998660f})
    sum = hn::MulAdd(sum, square, hn::Set(f, c));
  return hn::Mul(z, sum);
}

// Distance from the nearest multiple of the period.
HWY_INLINE V from_nearest(V walked, float period) {
  return hn::NegMulAdd(hn::Round(hn::Mul(walked, hn::Set(f, 1 / period))), hn::Set(f, period), walked);
}

template <LineStyle kStyle>
HWY_INLINE void draw_styled(const CasedLine& line, const Quarter& quarter, int x, int y, int pixels,
                            std::uint32_t* to) {
  constexpr float kRight = std::numbers::pi_v<float> / 2;
  // (u, v): from the arc's centre towards the corner. Where one is 0 the pixel lies beside a side, at `along` it.
  const float deep = quarter.outward_y * (static_cast<float>(y) + 0.5f - quarter.y);
  const float row = std::max(deep, 0.0f), below = row - deep;
  const V v = hn::Set(f, row), zero = hn::Zero(f);
  const int lanes = static_cast<int>(hn::Lanes(f));
  V px = hn::Add(hn::Iota(f, static_cast<float>(x)), hn::Set(f, 0.5f - quarter.x));
  for (int i = 0; i < pixels; i += lanes, px = hn::Add(px, hn::Set(f, static_cast<float>(lanes)))) {
    const V out = hn::Mul(px, hn::Set(f, quarter.outward_x));
    const V u = hn::Max(out, zero);
    const V distance = hn::Sub(hn::Sqrt(hn::MulAdd(u, u, hn::Mul(v, v))), hn::Set(f, line.radius));
    V off = hn::Abs(distance), part = hn::Set(f, 1.0f);
    if (kStyle != LineStyle::solid) {
      const V ratio = hn::Div(hn::Min(u, v), hn::Max(hn::Max(u, v), hn::Set(f, 1e-6f)));
      const V angle = arc_tangent(ratio);  // from the nearer side
      const V turned = hn::IfThenElse(hn::Gt(u, v), hn::Sub(hn::Set(f, kRight), angle), angle);
      const V along =
          hn::Sub(hn::Add(hn::Mul(turned, hn::Set(f, line.radius)), hn::Set(f, row > 0 ? 0.0f : below)),
                  hn::Sub(u, out));
      const V begin =
          hn::IfThenElse(hn::Gt(u, zero), hn::Set(f, quarter.walked), hn::Set(f, quarter.walked_level));
      const V walked = hn::MulAdd(along, hn::Set(f, quarter.direction), begin);
      if (kStyle == LineStyle::dashed) {
        const V middle = from_nearest(hn::Sub(walked, hn::Set(f, line.on / 2)), line.period);
        part = share(hn::Sub(hn::Set(f, line.on / 2), hn::Abs(middle)));
      } else {
        const V to_dot = from_nearest(walked, line.period);
        off = hn::Sqrt(hn::MulAdd(to_dot, to_dot, hn::Mul(off, off)));
      }
    }
    const V ink = hn::Mul(part, share(hn::Sub(hn::Set(f, line.half), off)));
    const V opaque = hn::Mul(ink, hn::Set(f, line.color.a));
    const V rim =
        hn::Mul(hn::Mul(part, hn::Set(f, line.casing_opacity)), share(hn::Sub(hn::Set(f, line.casing), off)));
    const V alpha = hn::Add(opaque, hn::NegMulAdd(opaque, rim, rim));
    store(words_of(alpha, ink, line.color), pixels - i, to + i);
  }
}

void quarter_row(const CasedLine& line, const Quarter& quarter, int x, int y, int pixels, std::uint32_t* to) {
  switch (line.style) {
    case LineStyle::solid:
      return draw_styled<LineStyle::solid>(line, quarter, x, y, pixels, to);
    case LineStyle::dashed:
      return draw_styled<LineStyle::dashed>(line, quarter, x, y, pixels, to);
    case LineStyle::dotted:
      return draw_styled<LineStyle::dotted>(line, quarter, x, y, pixels, to);
  }
}

void measure(const Stretch& stretch, const DepthMap& map, int left, int right, int top, int bottom) {
  const int lanes = static_cast<int>(hn::Lanes(f));
  left -= left % lanes;
  const float square = stretch.dx * stretch.dx + stretch.dy * stretch.dy,
              inverse = square > 0 ? 1 / square : 0;
  const V zero = hn::Zero(f), one = hn::Set(f, 1.0f);
  const V dx = hn::Set(f, stretch.dx), dy = hn::Set(f, stretch.dy), half = hn::Set(f, stretch.half),
          strength = hn::Set(f, stretch.strength), slope = hn::Set(f, stretch.dx * inverse);
  for (int y = top; y < bottom; ++y) {
    const float py = static_cast<float>(y) + 0.5f - stretch.y;
    const V ey0 = hn::Set(f, py), rise = hn::Set(f, py * stretch.dy * inverse);
    float* depth = map.depth + y * map.stride;
    float* strengths = map.strength + y * map.stride;
    for (int x = left; x < right; x += lanes) {
      const V px = hn::Add(hn::Iota(f, static_cast<float>(x)), hn::Set(f, 0.5f - stretch.x));
      const V t = hn::Min(hn::Max(hn::MulAdd(px, slope, rise), zero), one);
      const V ex = hn::NegMulAdd(t, dx, px), ey = hn::NegMulAdd(t, dy, ey0);
      const V here = hn::Sub(half, hn::Sqrt(hn::MulAdd(ex, ex, hn::Mul(ey, ey))));
      const V before = hn::LoadU(f, depth + x);
      const auto deeper = hn::Gt(here, before);
      hn::StoreU(hn::IfThenElse(deeper, strength, hn::LoadU(f, strengths + x)), f, strengths + x);
      hn::StoreU(hn::Max(here, before), f, depth + x);
    }
  }
}

void draw_map(const FadingLine& line, const DepthMap& map, int width, int height, std::uint32_t* to) {
  const int lanes = static_cast<int>(hn::Lanes(f));
  const V casing = hn::Set(f, line.casing), wide = hn::Set(f, line.casing_width), one = hn::Set(f, 1.0f);
  const V least = hn::Set(f, -line.casing_width - 0.5f);
  for (int y = 0; y < height; ++y, to += width) {
    const float* depths = map.depth + y * map.stride;
    const float* strengths = map.strength + y * map.stride;
    for (int x = 0; x < width; x += lanes) {
      const V depth = hn::LoadU(f, depths + x);
      if (hn::AllTrue(f, hn::Le(depth, least))) {
        store(hn::Zero(words), width - x, to + x);
        continue;
      }
      const V strength = hn::LoadU(f, strengths + x);
      const V inner = share(depth), ink = hn::Mul(strength, inner);
      const V rim =
          hn::Mul(hn::Mul(strength, casing), hn::Mul(share(hn::Add(depth, wide)), hn::Sub(one, inner)));
      store(words_of(hn::MulAdd(ink, hn::Set(f, line.color.a), rim), ink, line.color), width - x, to + x);
    }
  }
}

}  // namespace cerberus::overlay::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::overlay {

HWY_EXPORT(quarter_row);
HWY_EXPORT(measure);
HWY_EXPORT(draw_map);

void draw_quarter_row(const CasedLine& line, const Quarter& quarter, int x, int y, int pixels,
                      std::uint32_t* to) {
  HWY_DYNAMIC_DISPATCH(quarter_row)(line, quarter, x, y, pixels, to);
}

void measure_stretch(const Stretch& stretch, const DepthMap& map, int left, int right, int top, int bottom) {
  HWY_DYNAMIC_DISPATCH(measure)(stretch, map, left, right, top, bottom);
}

void draw_depth(const FadingLine& line, const DepthMap& map, int width, int height, std::uint32_t* words) {
  HWY_DYNAMIC_DISPATCH(draw_map)(line, map, width, height, words);
}

}  // namespace cerberus::overlay
#endif
