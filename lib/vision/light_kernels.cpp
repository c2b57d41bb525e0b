// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/light_kernels.h"

#include <algorithm>
#include <cstdlib>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "vision/light_kernels.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cerberus::vision::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// A plain loop, compiled once per target: compilers vectorise it as well as intrinsics would.
// Saturating at the ends as a sensor does; a gain below 8 and an offset of a few hundred levels keep 32 bits safe.
HWY_INLINE void relight(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  const std::int32_t gain = light.gain, offset = light.offset + 128;
  for (int x = 0; x < count; ++x) {
    const std::int32_t value = (reference[x] * gain + offset) >> 8;
    out[x] = static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
}

void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out) {
  relight(reference, light, count, out);
}

#if HWY_TARGET == HWY_SCALAR
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  relight_row_with_white_reference(reference, present, light, count, out);
}
LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third) {
  return sum_samples_reference(reference, present, lights, rows, third);
}
#else

void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out) {
  if (light == RowLight{}) return relight(reference, light, count, out);
  const std::int32_t gain = light.gain, offset = light.offset + 128;
  for (int x = 0; x < count; ++x) {
    const std::int32_t then = reference[x], seen = present[x];
    const std::int32_t value = (then * gain + offset) >> 8;
    const std::int32_t now = value < 0 ? 0 : value > 255 ? 255 : value;
    const std::int32_t low = then < now ? then : now, high = then < now ? now : then;
    const std::int32_t most = then >= kWhite ? 255 : high;
    const std::int32_t told = seen < low ? low : seen > most ? most : seen;
    out[x] = static_cast<std::uint8_t>(high >= kNearWhite ? told : now);
  }
}

LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third) {
  const hn::CappedTag<std::uint8_t, kSampleLanes> d;
  const hn::Repartition<std::uint64_t, decltype(d)> wide;
  using Sum = hn::Vec<decltype(wide)>;
  if (hn::Lanes(d) != kSampleLanes) return sum_samples_reference(reference, present, lights, rows, third);
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
        alignas(16) std::uint8_t lit[kSampleLanes];
        if (!same) relight(from, light, kSampleLanes, lit);
        const auto a = hn::LoadU(d, from), b = hn::LoadU(d, present + begin + x);
        const auto now = same ? a : hn::Load(d, lit);
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

HWY_EXPORT(relight_row);
HWY_EXPORT(relight_row_with_white);
HWY_EXPORT(sum_samples);

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
