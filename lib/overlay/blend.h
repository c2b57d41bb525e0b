// SPDX-License-Identifier: LGPL-2.1-or-later
// Blends small drawings onto a picture of any layout of bytes or of words of 16 bits. The cost is that of the drawing's
// pixels, whatever the size of the picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "vision/image/image.h"

namespace cerberus::overlay {

// One component (Y, Cb, Cr, R, G, B or A) of a picture. Its value for an opaque colour of 0..255 is
// red * R + green * G + blue * B + offset.
struct BlendComponent {
  std::uint8_t* data = nullptr;  // of pixel (0, 0)
  std::uint8_t* pixel =
      nullptr;                // first byte of pixel (0, 0) where several components share its bytes; or null
  std::ptrdiff_t stride = 0;  // bytes between rows of samples
  int step = 1;               // bytes between samples
  int shift_x = 0, shift_y = 0;  // a sample stands for 2^shift pixels; shift_y at most 1
  double red = 0, green = 0, blue = 0, offset = 0;
  int bits = 8;          // of a sample; more than 8: in a word of 16 bits
  int word_shift = 0;    // distance of the sample from the word's lowest bit (P010: 6)
  bool swapped = false;  // the word has the other byte order than this machine
};

// Blends a drawing over the picture, with its top left corner at pixel (x, y): c := c_drawing + c (1 - alpha) (Porter
// and Duff, SIGGRAPH 1984). The drawing consists of words of alpha, red, green, blue from the highest byte down,
// colours multiplied by alpha, and lies inside the picture. A sample that stands for several pixels takes their mean.
void blend(vision::View<const std::uint32_t> drawing, int x, int y, std::span<const BlendComponent> picture);

}  // namespace cerberus::overlay
