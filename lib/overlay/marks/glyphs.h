// SPDX-License-Identifier: LGPL-2.1-or-later
// Letters of one font, drawn by cairo once each and kept: text that changes with every frame costs no rasterising.
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
  // A sans-serif face at `size` pixels. The letters that were kept are those of the font before: they go.
  void select(double size, bool bold);
  // Sum of the letters' advances, pixels. ASCII only: other bytes take no room.
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
