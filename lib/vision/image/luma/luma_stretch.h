// SPDX-License-Identifier: LGPL-2.1-or-later
// Which part of the range of a deep format (10 to 16 bits) the picture's values lie in: thermal cameras use a few percent
// of it, which are next to nothing in 8 bits.
#pragma once

#include <array>
#include <cstdint>

#include "vision/image/luma/luma.h"

namespace cerberus::vision {

struct LumaStretchParameters {
  // Shares of the range: pictures whose values are spread over less are stretched. Chosen: ordinary video has .4 to .9, fog
  // .25. Guard: tests/unit/luma_stretch.cpp.
  double narrow = 0.25;
  // The least part of the range that is stretched. Derived: 10 K of a thermal camera with .01 K to a level, 16 levels of 10
  // bits; less is noise.
  double least = 1.0 / 64;
  // A picture whose values are spread over less is even: the stretch begins with the first one that is not. Derived: a
  // fifth of a thermal camera's noise.
  double even = 1.0 / 4096;
  // Left on either side of the values, in spans of them, for objects warmer than the room. Derived: a person at 305 K in a
  // room of 290 to 299 K lies within, or is white.
  double margin = 0.25;
  // Shares of the pixels: below and above lie single hot and dead pixels; and what may lie outside before the part moves.
  // Derived: a person fills 2 % of the picture at 5 m, and must not move it.
  double outliers = 0.01, outside = 0.05;
  // The part is narrowed where `outside` to 1 - `outside` fill less than this of it. Derived: two thirds of a fresh one are
  // filled.
  double filled = 0.125;
  // By how much of itself the part moves at most, a picture. Derived: 4 grey levels, which the change of light between two
  // pictures (LightChange) accounts for.
  double step = 1.0 / 64;
};

// The part stays as it is while it fits, so that pictures can be compared; else it moves slowly. Where half of the pixels lie
// outside, or all values but the `outside` at either end fill twice the part, it jumps: the scene is another one.
class LumaStretch {
 public:
  // The source with the part of its range that is to be white and black: low and span. A source of bytes, and one whose
  // values are spread over the range, stay as they are. Called once for each picture; allocates nothing.
  LumaSource stretched(const LumaSource& source);
  void reset() { part_ = {}, moves_ = false; }

 private:
  struct Part {
    double low = 0, span = 0;  // words; span 0: none yet
  };
  struct Levels {  // of the pixels, by shares: outliers, outside, half, and so on
    int darkest = 0, dark = 0, middle = 0, bright = 0, brightest = 0;
    bool operator==(const Levels&) const = default;
  };
  Levels levels_of(const LumaSource& source);
  static Part part_for(const Levels& levels, double range);
  void follow(const Levels& levels, double range);

  static constexpr int kColumns = 64, kRows = 32;  // of the pixels that are looked at, over the picture
  std::array<std::uint16_t, kColumns * kRows> samples_{};
  Levels last_;
  Part part_;
  bool moves_ = false;
};

}  // namespace cerberus::vision
