// SPDX-License-Identifier: LGPL-2.1-or-later
// The 3x3 box blur that is applied before pictures are compared: it reduces sensor noise and interpolation
// differences to a third.
#pragma once

#include "vision/image/image.h"

namespace cerberus::vision {

// out := mean of the 3x3 neighbourhood, rounded to nearest, border pixels repeated outwards; side 1 (below
// 3): a copy. Source and target must not overlap.
void blur3(GrayView picture, int side, MutableGrayView out);

// The same result by the definition, one pixel at a time: the reference for the tests.
void blur3_reference(GrayView picture, MutableGrayView out);

}  // namespace cerberus::vision
