// SPDX-License-Identifier: LGPL-2.1-or-later
// What light and a camera's sensor make of a scene: exposure, flicker, bands, noise.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::tests {

// Normal deviates, 1/64, from a table whose place every row chooses anew: cheap, and no two frames alike.
class Noise {
 public:
  Noise() : table_(kTable) {
    std::mt19937 random(7);
    std::normal_distribution<float> normal;
    for (auto& t : table_) t = static_cast<std::int16_t>(std::lround(64 * normal(random)));
  }
  const std::int16_t* row(int width) {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return table_.data() + (state_ >> 33) % static_cast<std::uint64_t>(kTable - width);
  }

 private:
  static constexpr int kTable = 1 << 18;
  std::vector<std::int16_t> table_;
  std::uint64_t state_ = 1;
};

// Light of a frame: the exposure, mains light that beats against the frame rate, and its bands under a rolling shutter.
struct Light {
  double exposure = 1, global = 0, bands = 0, period = 80;
  double phase = 0;
  double at(int y) const {
    return exposure * (1 + global * std::sin(phase)) *
           (1 + bands * std::sin(2 * std::numbers::pi * y / period + 1.7 * phase));
  }
};

// What the sensor makes of it: noise of sigma 2 in the dark to 6 in the bright, clipped.
inline void expose(const float* scene, std::ptrdiff_t stride, const Light& light, Noise& noise,
                   vision::MutableGrayView out) {
  for (int y = 0; y < out.height; ++y) {
    const auto gain = static_cast<float>(light.at(y));
    const float* s = scene + y * stride;
    const std::int16_t* n = noise.row(out.width);
    std::uint8_t* to = out.row(y);
    for (int x = 0; x < out.width; ++x) {
      const float value = std::min(gain * s[x], 255.0f);
      const float seen = value + (2 + value * (4 / 255.0f)) * n[x] * (1 / 64.0f) + 0.5f;
      to[x] = static_cast<std::uint8_t>(std::clamp(seen, 0.0f, 255.0f));
    }
  }
}

}  // namespace cerberus::tests
