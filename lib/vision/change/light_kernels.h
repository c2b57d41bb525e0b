// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of changes of light, chosen for the processor at run time, each with its scalar reference.
#pragma once

#include <array>
#include <cstdint>

namespace cerberus::vision {

constexpr int kWhite = 245;  // grey levels from which the sensor was possibly saturated
// Grey levels from which noise makes white. A choice by the present picture would exclude pixels that noise brightens.
constexpr int kNearWhite = 235;

// The light of a row relative to the reference: (value * gain + offset) / 256.
struct RowLight {
  std::int32_t gain = 256;
  std::int32_t offset = 0;
  bool operator==(const RowLight&) const = default;
};

// out := the row of the reference under the present light, clamped to 0..255. `out` may be `reference`.
void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out);
// The same for kSampleLanes samples.
constexpr int kSampleLanes = 16;
void relight_samples(const std::uint8_t* reference, RowLight light, std::uint8_t* out);
// As relight_row(), but a pixel near white in either light takes the value of `present` as far as that lies between its
// values under the two lights, or beyond white: pictures are blurred after saturation, so its true value is undetermined.
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out);
void relight_row_with_white_reference(const std::uint8_t* reference, const std::uint8_t* present,
                                      RowLight light, int count, std::uint8_t* out);

// to[i] := from[8 i] for i < number. Reads nothing beyond from[8 (number - 1)].
void take_every_eighth(const std::uint8_t* from, int number, std::uint8_t* to);

// The gains of samples beyond their light, 1/256, each counted half a level lower and half a level higher, because whole
// levels make steps in the gains of dark samples. Indices from 0, for -kReach, to 2 kReach, which hold what is beyond as
// well; the weight of white samples is 0. Origin of the numbers unknown: kept from the first version. Guard: flicker and
// bands in unit-foreground_mask.
struct SampleGains {
  static constexpr int kReach = 64;       // 1/256
  static constexpr int kFullWeight = 64;  // grey levels under the light: from there on a sample counts fully
  static constexpr int kHalfLevel = 128 * 256;  // half a grey level, 16 bits of fraction
  std::array<std::uint8_t, kSampleLanes> lower, higher, weight;
};
// `reference`, `now` (the same under the light) and `present`: kSampleLanes of them.
void find_gains(const std::uint8_t* reference, const std::uint8_t* now, const std::uint8_t* present,
                SampleGains& gains);
void find_gains_reference(const std::uint8_t* reference, const std::uint8_t* now, const std::uint8_t* present,
                          SampleGains& gains);

// Statistics of the light over samples of the reference and the present picture, by thirds of the picture's width. White
// samples do not count: below kWhite in the reference, below kNearWhite under the light.
struct LightSums {
  static constexpr int kMost = 16;  // grey levels
  std::array<std::int32_t, 3> number{}, brighter{}, darker{};
  std::int32_t level = 0;   // of the reference under the light, all together
  std::int32_t misfit = 0;  // remaining differences, at most kMost each
  bool operator==(const LightSums&) const = default;
};
// Samples are in rows of three thirds, each `third` long: a multiple of kSampleLanes, at most 255 of them; padding
// is white in the reference. One light for each row.
LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third);
LightSums sum_samples_reference(const std::uint8_t* reference, const std::uint8_t* present,
                                const RowLight* lights, int rows, int third);

}  // namespace cerberus::vision
