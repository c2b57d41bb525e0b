// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/light_kernels.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/change/light_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// (level * gain + offset + 128) >> 8 from its high and low bytes, so that 16 bits hold all. A gain below 80 and an offset
// of less than 10000 levels keep them safe. Rows are relit by plain loops, compiled once per target, which compilers
// vectorise as well as intrinsics would; samples, of which one vector holds all, without going through memory.
struct Relit {
  std::uint16_t gain_low, offset_low;
  std::int16_t gain_high, offset_high;

  explicit Relit(RowLight light)
      : gain_low(light.gain & 255),
        offset_low((light.offset + 128) & 255),
        gain_high(static_cast<std::int16_t>(light.gain >> 8)),
        offset_high(static_cast<std::int16_t>((light.offset + 128) >> 8)) {}
  // Saturating at the ends as a sensor does.
  HWY_INLINE std::uint8_t operator()(std::uint8_t level) const {
    const std::uint16_t low = static_cast<std::uint16_t>(level * gain_low + offset_low);
    const std::int16_t value = static_cast<std::int16_t>(level * gain_high + offset_high + (low >> 8));
    return static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
};

// Calls each(begin, bytes) for the pieces of a row. The caller copies each piece first, because `out` may be
// `reference` and possible aliasing would prevent vectorisation.
constexpr int kPiece = 32;
template <typename Each>
HWY_INLINE void in_pieces(int count, Each&& each) {
  for (int x = 0; x < count; x += kPiece) each(x, static_cast<std::size_t>(std::min(count - x, kPiece)));
}

HWY_INLINE void copy(std::uint8_t* to, const std::uint8_t* from, std::size_t bytes) {
  if (bytes == kPiece)  // no call
    std::memcpy(to, from, kPiece);
  else
    std::memcpy(to, from, bytes);
}

HWY_INLINE void relight(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  const Relit relit(light);
  in_pieces(count, [&](int x, std::size_t bytes) {
    std::uint8_t levels[kPiece] = {};
    copy(levels, reference + x, bytes);
    for (std::uint8_t& level : levels) level = relit(level);
    copy(out + x, levels, bytes);
  });
}

void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  relight(reference, light, count, out);
}

HWY_INLINE void take_each(const std::uint8_t* from, int number, std::uint8_t* to) {
  for (int i = 0; i < number; ++i) to[i] = from[8 * i];
}

#if HWY_TARGET == HWY_SCALAR
void relight_samples(const std::uint8_t* reference, RowLight light, std::uint8_t* out) {
  relight(reference, light, kSampleLanes, out);
}
void take_every_eighth(const std::uint8_t* from, int number, std::uint8_t* to) {
  take_each(from, number, to);
}
void find_gains(const std::uint8_t* reference, const std::uint8_t* now, const std::uint8_t* present,
                SampleGains& gains) {
  find_gains_reference(reference, now, present, gains);
}
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  relight_row_with_white_reference(reference, present, light, count, out);
}
LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third) {
  return sum_samples_reference(reference, present, lights, rows, third);
}
#else

using Samples = hn::FixedTag<std::uint8_t, kSampleLanes>;

HWY_INLINE hn::Vec<Samples> relit_samples(const std::uint8_t* reference, RowLight light) {
  const Relit relit(light);
  const hn::Half<Samples> bytes;
  const hn::Rebind<std::int16_t, decltype(bytes)> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const auto half = [&](const std::uint8_t* p) HWY_ATTR {
    const auto level = hn::PromoteTo(d, hn::LoadU(bytes, p));
    const auto low =
        hn::Add(hn::Mul(hn::BitCast(du, level), hn::Set(du, relit.gain_low)), hn::Set(du, relit.offset_low));
    const auto high = hn::Add(hn::Mul(level, hn::Set(d, relit.gain_high)), hn::Set(d, relit.offset_high));
    return hn::DemoteTo(bytes, hn::Add(high, hn::BitCast(d, hn::ShiftRight<8>(low))));
  };
  return hn::Combine(Samples(), half(reference + kSampleLanes / 2), half(reference));
}

void relight_samples(const std::uint8_t* reference, RowLight light, std::uint8_t* out) {
  hn::StoreU(relit_samples(reference, light), Samples(), out);
}

// Every sample is a byte of a 64-bit lane: the first one, or in the last vector, which begins 7 bytes earlier so that it
// ends with the last sample, the last one.
void take_every_eighth(const std::uint8_t* from, int number, std::uint8_t* to) {
  const hn::CappedTag<std::uint64_t, 8> wide;
  const hn::Rebind<std::uint8_t, decltype(wide)> bytes;
  const int lanes = static_cast<int>(hn::Lanes(wide));
  if (number <= lanes) return take_each(from, number, to);
  const auto load = [&](const std::uint8_t* p) HWY_ATTR {
    return hn::BitCast(wide, hn::LoadU(hn::Repartition<std::uint8_t, decltype(wide)>(), p));
  };
  for (int i = 0; i < number - lanes; i += lanes)
    hn::StoreU(hn::TruncateTo(bytes, load(from + 8 * i)), bytes, to + i);
  const int last = number - lanes;
  hn::StoreU(hn::TruncateTo(bytes, hn::ShiftRight<56>(load(from + 8 * last - 7))), bytes, to + last);
}

void find_gains(const std::uint8_t* reference, const std::uint8_t* now, const std::uint8_t* present,
                SampleGains& gains) {
  const hn::CappedTag<std::int32_t, 8> d;
  const hn::Rebind<float, decltype(d)> floats;
  const hn::Rebind<std::uint8_t, decltype(d)> bytes;
  const int lanes = static_cast<int>(hn::Lanes(d));
  const auto reach = hn::Set(d, SampleGains::kReach);
  for (int i = 0; i < kSampleLanes; i += lanes) {
    const auto load = [&](const std::uint8_t* p)
                          HWY_ATTR { return hn::PromoteTo(d, hn::LoadU(bytes, p + i)); };
    const auto level = load(now);
    // The quotient's whole part, with half a unit added to the dividend, which leaves it as it is, so that division need not
    // round correctly.
    const auto divisor = hn::ConvertTo(floats, hn::Max(level, hn::Set(d, 1)));
    const auto half = hn::ConvertTo(d, hn::Div(hn::Set(floats, SampleGains::kHalfLevel + 0.5f), divisor));
    const auto middle = hn::Mul(hn::ShiftLeft<1>(hn::Sub(load(present), level)), half);
    const auto index = [&](auto gain) HWY_ATTR {
      const auto limited = hn::Max(hn::Min(hn::ShiftRight<8>(gain), reach), hn::Neg(reach));
      return hn::DemoteTo(bytes, hn::Add(limited, reach));
    };
    hn::StoreU(index(hn::Sub(middle, half)), bytes, gains.lower.data() + i);
    hn::StoreU(index(hn::Add(middle, half)), bytes, gains.higher.data() + i);
    const auto counts =
        hn::And(hn::Lt(load(reference), hn::Set(d, kWhite)), hn::Lt(level, hn::Set(d, kNearWhite)));
    const auto weight = hn::Min(level, hn::Set(d, SampleGains::kFullWeight));
    hn::StoreU(hn::DemoteTo(bytes, hn::IfThenElseZero(counts, weight)), bytes, gains.weight.data() + i);
  }
}

void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  if (light == RowLight{}) return relight(reference, light, count, out);
  const Relit relit(light);
  in_pieces(count, [&](int at, std::size_t bytes) {
    std::uint8_t levels[kPiece] = {}, now_seen[kPiece] = {};
    copy(levels, reference + at, bytes);
    copy(now_seen, present + at, bytes);
    for (int x = 0; x < kPiece; ++x) {
      const std::uint8_t then = levels[x], seen = now_seen[x], now = relit(then);
      const std::uint8_t low = then < now ? then : now, high = then < now ? now : then;
      const std::uint8_t most = then >= kWhite ? 255 : high;
      const std::uint8_t limited = seen < low ? low : seen > most ? most : seen;
      levels[x] = high >= kNearWhite ? limited : now;
    }
    copy(out + at, levels, bytes);
  });
}

LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third) {
  const Samples d;
  const hn::Repartition<std::uint64_t, decltype(d)> wide;
  using Sum = hn::Vec<decltype(wide)>;
  const auto white = hn::Set(d, kWhite), near_white = hn::Set(d, kNearWhite);
  const auto most = hn::Set(d, LightSums::kMost);
  LightSums sums;
  Sum level = hn::Zero(wide), misfit = hn::Zero(wide);
  const auto total = [&](Sum sum) {
    return static_cast<std::int32_t>(hn::GetLane(hn::SumOfLanes(wide, sum)));
  };
  for (int part = 0; part < 3; ++part) {
    Sum number = hn::Zero(wide), brighter = hn::Zero(wide), darker = hn::Zero(wide);
    for (int row = 0; row < rows; ++row) {
      const RowLight light = lights[row];
      const bool same = light.gain == 256 && light.offset == 0;
      const std::ptrdiff_t begin = static_cast<std::ptrdiff_t>(3 * row + part) * third;
      auto n = hn::Zero(d), up = hn::Zero(d),
           down = hn::Zero(d);  // by lane; counted down by masks of ones, -1
      for (int x = 0; x < third; x += kSampleLanes) {
        const std::uint8_t* from = reference + begin + x;
        const auto a = hn::LoadU(d, from), b = hn::LoadU(d, present + begin + x);
        const auto now = same ? a : relit_samples(from, light);
        const auto use = hn::And(hn::Lt(a, white), hn::Lt(now, near_white));
        const auto above = hn::SaturatedSub(b, now), below = hn::SaturatedSub(now, b);
        n = hn::Sub(n, hn::VecFromMask(d, use));
        up = hn::Sub(up, hn::VecFromMask(d, hn::And(use, hn::Gt(b, now))));
        down = hn::Sub(down, hn::VecFromMask(d, hn::And(use, hn::Lt(b, now))));
        level = hn::Add(level, hn::SumsOf8(hn::IfThenElseZero(use, now)));
        misfit = hn::Add(misfit, hn::SumsOf8(hn::IfThenElseZero(use, hn::Min(hn::Or(above, below), most))));
      }
      number = hn::Add(number, hn::SumsOf8(n));
      brighter = hn::Add(brighter, hn::SumsOf8(up));
      darker = hn::Add(darker, hn::SumsOf8(down));
    }
    sums.number[part] = total(number);
    sums.brighter[part] = total(brighter);
    sums.darker[part] = total(darker);
  }
  sums.level = total(level);
  sums.misfit = total(misfit);
  return sums;
}
#endif

}  // namespace cerberus::vision::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cerberus::vision {

HWY_EXPORT(find_gains);
HWY_EXPORT(take_every_eighth);
HWY_EXPORT(relight_samples);
HWY_EXPORT(relight_row);
HWY_EXPORT(relight_row_with_white);
HWY_EXPORT(sum_samples);

void find_gains(const std::uint8_t* reference, const std::uint8_t* now, const std::uint8_t* present,
                SampleGains& gains) {
  HWY_DYNAMIC_DISPATCH(find_gains)(reference, now, present, gains);
}
void take_every_eighth(const std::uint8_t* from, int number, std::uint8_t* to) {
  HWY_DYNAMIC_DISPATCH(take_every_eighth)(from, number, to);
}
void relight_samples(const std::uint8_t* reference, RowLight light, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(relight_samples)(reference, light, out);
}
void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(relight_row)(reference, light, count, out);
}
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  HWY_DYNAMIC_DISPATCH(relight_row_with_white)(reference, present, light, count, out);
}
LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third) {
  return HWY_DYNAMIC_DISPATCH(sum_samples)(reference, present, lights, rows, third);
}

void find_gains_reference(const std::uint8_t* reference, const std::uint8_t* now, const std::uint8_t* present,
                          SampleGains& gains) {
  constexpr int kReach = SampleGains::kReach;
  for (std::size_t i = 0; i < kSampleLanes; ++i) {
    const int half = SampleGains::kHalfLevel / std::max<int>(now[i], 1);
    const auto index = [&](int halves) {
      return static_cast<std::uint8_t>(std::clamp((halves * half) >> 8, -kReach, kReach) + kReach);
    };
    const int twice = 2 * (present[i] - now[i]);
    gains.lower[i] = index(twice - 1);
    gains.higher[i] = index(twice + 1);
    const bool white = reference[i] >= kWhite || now[i] >= kNearWhite;
    gains.weight[i] = white ? 0 : std::min(now[i], std::uint8_t{SampleGains::kFullWeight});
  }
}

void relight_row_with_white_reference(const std::uint8_t* reference, const std::uint8_t* present,
                                      RowLight light, int count, std::uint8_t* out) {
  for (int x = 0; x < count; ++x) {
    const int then = reference[x];
    const int now = std::clamp((then * light.gain + light.offset + 128) >> 8, 0, 255);
    const auto [low, high] = std::minmax(then, now);
    const bool near_white = light != RowLight{} && high >= kNearWhite;
    out[x] = static_cast<std::uint8_t>(
        near_white ? std::clamp<int>(present[x], low, then >= kWhite ? 255 : high) : now);
  }
}

LightSums sum_samples_reference(const std::uint8_t* reference, const std::uint8_t* present,
                                const RowLight* lights, int rows, int third) {
  LightSums sums;
  for (int row = 0; row < rows; ++row)
    for (int part = 0; part < 3; ++part)
      for (int x = 0; x < third; ++x, ++reference, ++present) {
        const int now = std::clamp((*reference * lights[row].gain + lights[row].offset + 128) >> 8, 0, 255);
        if (*reference >= kWhite || now >= kNearWhite) continue;
        ++sums.number[part];
        sums.brighter[part] += *present > now;
        sums.darker[part] += *present < now;
        sums.level += now;
        sums.misfit += std::min(std::abs(*present - now), LightSums::kMost);
      }
  return sums;
}

}  // namespace cerberus::vision
#endif
