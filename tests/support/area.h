// SPDX-License-Identifier: LGPL-2.1-or-later
// From pictures to the moving area, and how well that shows a square that moves.
#pragma once

#include "support/pictures.h"
#include "vision/background/foreground_mask.h"
#include "vision/change/three_frame_difference.h"

namespace cerberus::tests {

// Both stages in a row, as the elements run them.
struct AreaChain {
  explicit AreaChain(vision::Size size) : current(size), previous(size), mask(size) {}
  vision::ForegroundMaskResult feed(vision::GrayView picture, const vision::Transform& motion = {},
                                    bool still = true, double seconds = 0) {
    const auto d = difference.update(picture, motion, current.view(), previous.view(), {}, histogram);
    return area.update({.picture = picture,
                        .motion = motion,
                        .still = still,
                        .current = current.view(),
                        .previous = previous.view(),
                        .histogram = &histogram,
                        .frames = d.frames,
                        .seconds = seconds},
                       mask.view());
  }
  void reset() {
    difference.reset();
    area.reset();
  }
  long moving() {
    long n = 0;
    for (int y = 0; y < mask.size().height; ++y)
      for (int x = 0; x < mask.size().width; ++x) n += mask.view().at(x, y) != 0;
    return n;
  }
  vision::ThreeFrameDifference difference;
  vision::ForegroundMask area;
  vision::Image<std::uint8_t> current, previous, mask;
  vision::Histogram histogram{};
};

struct Square {
  double x, y;
  int side;
};

// F of the mask against a square, over everything but a border.
struct Score {
  double hit = 0, wrong = 0, missed = 0;
  void add(vision::GrayView mask, const Square& s, int border = 4) {
    for (int y = border; y < mask.height - border; ++y)
      for (int x = border; x < mask.width - border; ++x) {
        const bool in = x >= s.x && x < s.x + s.side && y >= s.y && y < s.y + s.side, on = mask.at(x, y) != 0;
        hit += in && on, wrong += !in && on, missed += in && !on;
      }
  }
  double f() const { return 2 * hit / (2 * hit + wrong + missed); }
};

inline void draw(vision::MutableGrayView picture, const Square& s, const Scene& texture) {
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x)
      if (x >= s.x && x < s.x + s.side && y >= s.y && y < s.y + s.side)
        picture.at(x, y) = to_byte(texture.at(x - s.x, y - s.y) + 45);
}

}  // namespace cerberus::tests
