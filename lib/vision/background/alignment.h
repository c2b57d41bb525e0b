// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the frame really is against the scene's memory: the frame-to-frame motion says it to a fraction of a pixel,
// and those fractions add up. One Gauss-Newton step over block sums takes them out again.
#pragma once

#include <optional>
#include <span>

#include "vision/background/background_kernels.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

// The correction c for which frame(A(c(q))) fits memory(q) best, given the sums of e(q) = frame(A(q)) - memory(q):
// q + d(q), where d is the displacement of a homography to first order (8 unknowns about the centre), fitted by least
// squares to sum (e + grad . d)^2 over the blocks. A block's weight falls with what the fit leaves unexplained in it
// (square of a Cauchy weight, scale 2 grey levels), so that moving objects do not pull. `blocks` are in rows of
// `columns` > 0, side kBackgroundBlock. None when it is below 0.04 pixel at every corner (nothing to gain), not finite, or
// above 12 pixels (not a correction any more).
std::optional<Transform> align_to_background(std::span<const BlockSums> blocks, int columns, Size picture);

}  // namespace cerberus::vision
