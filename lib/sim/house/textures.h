// SPDX-License-Identifier: LGPL-2.1-or-later
// Pictures of surfaces, made of seeded noise and lines. Each repeats after 256 texels of a centimetre; eight levels, each
// half the resolution of the one before, so that a distant surface does not alias.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/house/floor_plan.h"

namespace cerberus::sim {

// An even distribution over 32 bits, of any numbers.
constexpr std::uint32_t scramble(std::uint32_t a, std::uint32_t b = 0, std::uint32_t c = 0) {
  std::uint32_t h = a * 0x9E3779B1u ^ (b + 0x7F4A7C15u) * 0x85EBCA77u ^ (c + 0x165667B1u) * 0xC2B2AE3Du;
  h ^= h >> 15, h *= 0x2C1B3C6Du;
  h ^= h >> 12, h *= 0x297A2D39u;
  return h ^ h >> 15;
}

class Texture {
 public:
  static constexpr int kSize = 256, kLevels = 8;
  static constexpr double kTexels = 100;  // a metre

  Texture(Surface surface, std::uint32_t seed);

  // level: 0 to kLevels - 1; u, v: texels of level 0.
  std::uint8_t at(int level, int u, int v) const {
    const int size = kSize >> level;
    return levels_[level][((v >> level) & (size - 1)) * size + ((u >> level) & (size - 1))];
  }
  // Where a pixel is that many metres wide.
  static int level_of(double metres);

 private:
  std::array<std::vector<std::uint8_t>, kLevels> levels_;
};

}  // namespace cerberus::sim
