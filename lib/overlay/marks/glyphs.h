// SPDX-License-Identifier: LGPL-2.1-or-later
// Letters of one font, each drawn by cairo once and stored: text that changes with every frame needs no rasterising.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "overlay/color.h"
#include "vision/image/image.h"

namespace cerberus::overlay {

class Glyphs {
 public:
  // Selects a sans-serif face at `size` pixels. Stored letters of another font are dropped.
  void select(double size, bool bold);
  // Returns the sum of the letters' advances, pixels. ASCII only: other bytes have no width.
  double width(std::string_view text);
  // Writes the text into a picture, its base line beginning at (x, base), rounded to pixels.
  void draw(std::string_view text, double x, double base, Color color, vision::View<std::uint32_t> picture);

 private:
  struct Glyph {
    bool known = false;
    double advance = 0;
    int left = 0, top = 0, width = 0, height = 0;  // of the coverage, from the origin on the base line
    std::vector<std::uint8_t> coverage;
  };
  Glyph* glyph(char letter);
  void render(char letter, Glyph& glyph) const;

  double size_ = 0;
  bool bold_ = false;
  std::array<Glyph, 128> glyphs_;
};

}  // namespace cerberus::overlay
