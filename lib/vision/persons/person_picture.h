// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture as a people detector gets it: brightness, and colours where the frame has them.
#pragma once

#include <array>
#include <cstdint>

#include "vision/image/image.h"
#include "vision/image/luma/luma.h"

namespace cerberus::vision {

// What the two planes beside the brightness hold.
enum class ColourPlanes : std::uint8_t {
  none,
  blue_red,          // blue and red of RGB, 0 to 255
  difference_video,  // Cb and Cr (BT.601) beside brightness from 16 to 235
  difference_full,   // the same beside brightness from 0 to 255
};

struct PersonPicture {
  PersonPicture() = default;
  PersonPicture(GrayView brightness) : luma(brightness) {}  // NOLINT: a grey picture is one, too

  GrayView luma;
  GrayView blue, red;  // over the same picture, of any size; empty where there are none
  ColourPlanes planes = ColourPlanes::none;
};

// Red, green and blue of a pixel, 0 to 255. Without planes all are the brightness.
// BT.601: R = Y + 1.402 (Cr - 128), G = Y - .344 (Cb - 128) - .714 (Cr - 128), B = Y + 1.772 (Cb - 128) with Y from 0 to 255;
// from 16 to 235 all are 255 / 219 times as far from Y = 16, and differences 255 / 224. Of RGB, whose brightness is (77 R +
// 150 G + 29 B) / 256, green is what remains.
std::array<std::uint8_t, 3> rgb_of(int luma, int blue, int red, ColourPlanes planes);

// Where a frame holds them.
struct PictureSource {
  LumaSource luma{}, blue{}, red{};
  ColourPlanes planes = ColourPlanes::none;
};

// An own copy of a part of a frame.
class PictureCopy {
 public:
  // The part of so many pixels at x, y, which lies in the frame. colours: with its colours, where there are any.
  void take(const PictureSource& source, int x, int y, Size part, bool colours);
  PersonPicture view() const;

 private:
  LumaScaler scaler_;
  Image<std::uint8_t> luma_, blue_, red_;
  ColourPlanes planes_ = ColourPlanes::none;
};

}  // namespace cerberus::vision
