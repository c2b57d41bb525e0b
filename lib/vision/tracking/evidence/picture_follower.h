// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the inside of a box went from one picture to the next, by sparse optical flow (Z. Kalal, K. Mikolajczyk,
// J. Matas, "Forward-backward error", ICPR 2010).
#pragma once

#include <optional>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/pyramid.h"

namespace cerberus::vision {

struct BoxStep {
  Point shift;        // of the box's middle, pixels
  double growth = 1;  // factor on its size
};

// box: pixels of both pictures; guess: expected shift. Points in the middle of the box are followed to `now` and back;
// those that return give the median shift, and the median ratio of their distances. nullopt: too few return.
std::optional<BoxStep> follow_box(const Pyramid& before, const Pyramid& now, const Box& box,
                                  const Point& guess);

}  // namespace cerberus::vision
