// SPDX-License-Identifier: LGPL-2.1-or-later
// Mathematical morphology of masks with square elements, and what is built on it: closing, opening, reconstruction. A
// 320x240 closing of 11 takes a few microseconds.
#pragma once

#include "vision/image/image.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// `side` is the square's side in pixels; even sides count as the next odd one, below 2 nothing happens.
// Outside the picture nothing is set for a dilation and everything for an erosion: closing never removes and
// opening never adds a pixel, at the border as inside. All work in place and keep their scratch: no
// allocation at one picture size.
class Morphology {
 public:
  // `width` is the picture's width in pixels (a BitView knows words only). Masks are whole ones: no words between rows.
  void dilate(MutableBitView bits, int width, int side);
  void erode(MutableBitView bits, int width, int side);
  void close(MutableBitView bits, int width, int side);
  void open(MutableBitView bits, int width, int side);
  // Keeps a pixel that has at least `least` set ones in its 3x3 neighbourhood, itself included (5: median).
  void vote(MutableBitView bits, int width, int least);
  // Reconstruction: seeds := the 8-connected parts of `within` that hold a seed.
  void reconstruct(MutableBitView seeds, BitView within);

  std::size_t bytes() const { return scratch_.bytes(); }

 private:
  BitMask scratch_;
};

// The definitions, one pixel at a time: what the tests hold the fast ones against.
void dilate_reference(GrayView mask, int side, MutableGrayView out);
void erode_reference(GrayView mask, int side, MutableGrayView out);

}  // namespace cerberus::vision
