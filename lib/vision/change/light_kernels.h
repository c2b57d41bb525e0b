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
// The same, but a pixel near white in either light takes the value of `present` as far as that lies between its values
// under the two lights, or beyond white: pictures are blurred after saturation, so its true value is undetermined.
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out);
void relight_row_with_white_reference(const std::uint8_t* reference, const std::uint8_t* present,
                                      RowLight light, int count, std::uint8_t* out);

// Statistics of the light over samples of the reference and the present picture, by thirds of the picture's width. White
// samples do not count: below kWhite in the reference, below kNearWhite under the light.
struct LightSums {
  static constexpr int kMost = 16;  // grey levels
  std::array<std::int32_t, 3> number{}, brighter{}, darker{};
  std::int32_t level = 0;   // of the reference under the light, all together
  std::int32_t misfit = 0;  // remaining differences, at most kMost each
  bool operator==(const LightSums&) const = default;
};
constexpr int kSampleLanes = 16;
// Samples are in rows of three thirds, each `third` long: a multiple of kSampleLanes, at most 255 of them; padding
// is white in the reference. One light for each row.
LightSums sum_samples(const std::uint8_t* reference, const std::uint8_t* present, const RowLight* lights,
                      int rows, int third);
LightSums sum_samples_reference(const std::uint8_t* reference, const std::uint8_t* present,
                                const RowLight* lights, int rows, int third);

}  // namespace cerberus::vision
