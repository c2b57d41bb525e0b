// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of changes of light, chosen for the processor at run time.
#pragma once

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
  // Saturating at the ends as a sensor does.
  std::uint8_t operator()(std::uint8_t level) const {
    const int value = (level * gain + offset + 128) >> 8;
    return static_cast<std::uint8_t>(value < 0 ? 0 : value > 255 ? 255 : value);
  }
};

// out := the row of the reference under the present light. `out` may be `reference`.
void relight_row(const std::uint8_t* reference, RowLight light, int count, std::uint8_t* out);
// The same, but a pixel near white in either light takes the value of `present` as far as that lies between its values
// under the two lights, or beyond white: pictures are blurred after saturation, so its true value is undetermined.
void relight_row_with_white(const std::uint8_t* reference, const std::uint8_t* present, RowLight light,
                            int count, std::uint8_t* out);

}  // namespace cerberus::vision
