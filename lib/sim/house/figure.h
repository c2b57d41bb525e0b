// SPDX-License-Identifier: LGPL-2.1-or-later
// A person's body as limbs: rounded, tapered parts between two joints. Metres; x and y as in floor_plan.h, z up.
#pragma once

#include <array>
#include <cstdint>

#include "sim/house/walker.h"

namespace cerberus::sim {

struct Point {
  double x = 0, y = 0, z = 0;
};

enum class Part { skin, hair, shirt, trousers, shoes };
inline constexpr int kParts = 5;

// Clothes: grey levels below full light, and how strong their pattern is.
struct Clothes {
  std::array<double, kParts> grey{150, 50, 110, 70, 40};
  std::array<double, kParts> pattern{.05, .2, .3, .2, .1};
  double stripes = 0;  // of the shirt, grey levels
  std::uint32_t seed = 1;
};

// Clothes of any grey, by a seed.
Clothes clothes_of(std::uint32_t seed);

struct Limb {
  Point from, to;
  double wide_from = 0, wide_to = 0;  // half of the width at each end
  double flat = 1;                    // depth over width of its cross section
  double cap = 1;                     // height of its rounded ends over half of the width
  Part part = Part::shirt;
};

inline constexpr int kLimbs = 18;
// sideways: unit vector to the person's right, along which limbs that are flat have their width.
struct Body {
  std::array<Limb, kLimbs> limbs;
  double sideways_x = 0, sideways_y = 0;
};
Body body_of(const Stance& stance, double height);

}  // namespace cerberus::sim
