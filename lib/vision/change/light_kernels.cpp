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

// (level * gain + offset + 128) >> 8 from its high and low bytes, so that 16 bits hold all: plain loops, compiled once
// per target; compilers vectorise them as well as intrinsics would. A gain below 80 and an offset of less than
// 10000 levels keep them safe.
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
