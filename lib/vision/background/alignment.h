// SPDX-License-Identifier: LGPL-2.1-or-later
// Registration of the frame to the background model. Frame-to-frame motion has errors of fractions of a pixel, which
// add up; one Gauss-Newton step over block sums removes them.
#pragma once

#include <optional>
#include <span>

#include "vision/background/background_kernels.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

// Returns the correction c for which frame(A(c(q))) fits background(q) best, given the sums of
// e(q) = frame(A(q)) - background(q): q + d(q), d being the displacement of a homography to first order (8 unknowns
// about the centre), fitted by least squares to sum (e + grad . d)^2 over the blocks. A block's weight falls with the
// residual of the fit in it (square of a Cauchy weight, scale 2 grey levels), so that moving objects do not bias it.
// `blocks` are in rows of `columns` > 0, side kBackgroundBlock. nullopt if the correction is below 0.04 pixel at every
// corner (nothing to gain), above 12 pixels (no correction any more), or not finite.
std::optional<Transform> align_to_background(std::span<const BlockSums> blocks, int columns, Size picture);

}  // namespace cerberus::vision
