// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a part of a picture went in the next one, by the least sum of absolute differences.
#pragma once

#include <optional>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

// Returns the displacement, in pixels, of what `patch` (pixels) shows in `before`. guess: expected displacement;
// reach: pixels around it that are searched in each direction. Equal sums: the nearest to the guess. Between whole
// pixels a parabola through the sums is used. Returns the guess where patch or search area leave no pixel to compare.
Point match_patch(GrayView before, GrayView now, const Box& patch, Point guess, int reach);

// Mean absolute difference, each pixel's limited to `most`, between `patch` (pixels) in `before` and the same patch,
// displaced, in `now`, over what both show. nullopt: they have less than half of the patch in common.
std::optional<double> patch_difference(GrayView before, GrayView now, const Box& patch, Point displaced,
                                       int most);

}  // namespace cerberus::vision
