// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/textures.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {
namespace {

constexpr int kSize = Texture::kSize;

double even(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return scramble(a, b, c) / 4294967296.;
}

// Smooth noise from 0 to 1 that repeats after kSize; cell: texels, a power of two.
double noise(int u, int v, int cell_u, int cell_v, std::uint32_t seed) {
  const int columns = kSize / cell_u, rows = kSize / cell_v;
  const int i = u / cell_u, j = v / cell_v;
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double x = ease(double(u % cell_u) / cell_u), y = ease(double(v % cell_v) / cell_v);
  const auto corner = [&](int a, int b) {
    return even(std::uint32_t((i + a) % columns), std::uint32_t((j + b) % rows), seed);
  };
  return (corner(0, 0) * (1 - x) + corner(1, 0) * x) * (1 - y) +
         (corner(0, 1) * (1 - x) + corner(1, 1) * x) * y;
}

// Grey levels of a texel below full light.
double texel(Surface surface, int u, int v, std::uint32_t seed) {
  const double fine = noise(u, v, 2, 2, seed) - .5, coarse = noise(u, v, 32, 32, seed + 1) - .5,
               broad = noise(u, v, 128, 64, seed + 2) - .5;
  switch (surface) {
    case Surface::plaster:
      return 176 + 7 * fine + 12 * coarse + 16 * broad;
    case Surface::brick: {
      const int row = v / 8, along = u + (row % 2) * 16;
      const bool joint = v % 8 == 0 || along % 32 == 0;
      return joint ? 150 + 10 * fine
                   : 90 + 40 * even(std::uint32_t(along / 32 % 8), std::uint32_t(row), seed) + 20 * fine;
    }
    case Surface::wood: {
      const int board = u / 32;
      if (u % 32 < 2) return 88;
      return 105 + 30 * even(std::uint32_t(board), 0, seed) + 36 * (noise(u, v, 2, 64, seed + 3) - .5) +
             8 * fine;
    }
    case Surface::carpet:
      return 92 + 34 * fine + 12 * coarse + 10 * broad;
    case Surface::tiles: {
      if (u % 64 < 2 || v % 64 < 2) return 112;
      return 150 + 22 * even(std::uint32_t(u / 64), std::uint32_t(v / 64), seed) + 8 * fine + 14 * coarse;
    }
    case Surface::concrete:
      return 130 + 20 * fine + 26 * coarse + 16 * broad;
    case Surface::panels: {
      if (u % 64 < 3 || v % 64 < 3) return 168;
      return 205 + 22 * fine;
    }
    case Surface::books: {
      const int shelf = v / 32;
      if (v % 32 < 3) return 85 + 10 * fine;
      const int book = u / 4;
      const double height = 18 + 10 * even(std::uint32_t(book), std::uint32_t(shelf), seed);
      if (32 - v % 32 > height) return 28;
      return 50 + 150 * even(std::uint32_t(book), std::uint32_t(shelf), seed + 1) + 12 * fine -
             (u % 4 == 0 ? 25 : 0);
    }
    case Surface::cloth:
      return 128 + 22 * fine + 30 * coarse + 26 * (noise(u, v, 4, 16, seed + 4) - .5) +
             20 * (noise(u, v, 32, 8, seed + 5) - .5);
    case Surface::metal:
      return 140 + 16 * (noise(u, v, 128, 2, seed + 6) - .5) + 14 * broad - (u % 128 < 2 ? 60 : 0);
  }
  return 0;
}

}  // namespace

Texture::Texture(Surface surface, std::uint32_t seed) {
  levels_[0].resize(std::size_t(kSize) * kSize);
  for (int v = 0; v < kSize; ++v)
    for (int u = 0; u < kSize; ++u)
      levels_[0][std::size_t(v) * kSize + u] =
          std::uint8_t(std::clamp(texel(surface, u, v, seed), 0., 255.) + .5);
  for (int level = 1; level < kLevels; ++level) {
    const int size = kSize >> level;
    const std::vector<std::uint8_t>& from = levels_[level - 1];
    levels_[level].resize(std::size_t(size) * size);
    for (int v = 0; v < size; ++v)
      for (int u = 0; u < size; ++u) {
        const std::uint8_t* four = &from[std::size_t(4) * v * size + 2 * u];
        levels_[level][std::size_t(v) * size + u] =
            std::uint8_t((four[0] + four[1] + four[2 * size] + four[2 * size + 1] + 2) / 4);
      }
  }
}

int Texture::level_of(double metres) {
  const double texels = metres * kTexels;
  return texels < 1 ? 0 : std::min(int(std::log2(texels) + .8), kLevels - 1);
}

}  // namespace cerberus::sim
