// SPDX-License-Identifier: LGPL-2.1-or-later
// Colours of identities, and colours as premultiplied words.
#pragma once

#include <cstdint>

namespace cerberus::overlay {

struct Color {
  double r = 0, g = 0, b = 0;  // 0 to 1
  bool operator==(const Color&) const = default;
};

// Returns the colour of an identity: 0 = no identity is white, every other identity takes the next of seven colours.
// The eight colours can be distinguished with any colour vision (Okabe and Ito, 2008, with white instead of black).
Color identity_color(std::uint32_t id);

// A colour times its alpha, 0 to 1 each.
struct Premultiplied {
  float a = 0, r = 0, g = 0, b = 0;

  Premultiplied() = default;
  Premultiplied(Color color, double alpha)
      : a(static_cast<float>(alpha)),
        r(static_cast<float>(color.r * alpha)),
        g(static_cast<float>(color.g * alpha)),
        b(static_cast<float>(color.b * alpha)) {}

  // The colour of a pixel that is covered to a share of 0 to 1.
  Premultiplied operator*(float share) const {
    Premultiplied p = *this;
    p.a *= share, p.r *= share, p.g *= share, p.b *= share;
    return p;
  }
  Premultiplied operator+(const Premultiplied& other) const {
    Premultiplied p = *this;
    p.a += other.a, p.r += other.r, p.g += other.g, p.b += other.b;
    return p;
  }
  // This colour over `below` (Porter and Duff, SIGGRAPH 1984).
  Premultiplied over(const Premultiplied& below) const { return *this + below * (1 - a); }
  // Alpha, red, green, blue from the highest byte down.
  std::uint32_t word() const {
    const auto byte = [](float share) { return static_cast<std::uint32_t>(255 * share + 0.5f); };
    return byte(a) << 24 | byte(r) << 16 | byte(g) << 8 | byte(b);
  }
};

}  // namespace cerberus::overlay
