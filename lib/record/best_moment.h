// SPDX-License-Identifier: LGPL-2.1-or-later
// Scores how well an object can be seen in a frame: the picture of an event is that of its highest score.
#pragma once

#include "vision/geometry/box.h"
#include "vision/image/image.h"

namespace cerberus::record {

struct BestMomentParameters {
  // Grey levels of mean gradient at which an object counts half of a perfectly sharp one. Chosen: between the gradient
  // of a blurred object and that of a sharp one. Guarded by the test of a blurred object.
  double half_sharp = 8;
  // Share of the score that an object loses whose centre is in the picture's corner. Chosen: of two equal views the
  // central one, but a view of twice the size before a central one. Guarded by the test of size against place.
  double corner_loss = .5;
  // Pixels of the box that are read at most. Derived: the mean of n gradients is exact to 1 / sqrt(n) of their spread,
  // here 1.6 %. Guarded by the test of a large box.
  int most_samples = 4096;
};

// Returns the mean absolute difference, in grey levels, of horizontal and vertical neighbours within `box`, which is
// in pixels of `luma` and is clamped to it. 0 for an empty box.
double sharpness(vision::GrayView luma, const vision::Box& box, const BestMomentParameters& parameters = {});

// Returns a score above 0 for `box`, in pixels of a frame of size `frame`: the square root of its share of the frame,
// times (s + 1) / (s + 1 + half_sharp) for the sharpness s, times 1 - corner_loss * the distance of its centre from the frame's
// centre in half diagonals. 0 for a box without area in the frame.
double view_score(const vision::Box& box, vision::Size frame, double sharpness,
                  const BestMomentParameters& parameters = {});

}  // namespace cerberus::record
