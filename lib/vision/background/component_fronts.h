// SPDX-License-Identifier: LGPL-2.1-or-later
// Who walks straight up or down the picture, or towards the camera, is seen to move only at his fronts: head, waist and
// feet. What is even between them differs from nothing, neither from the frame before nor from a memory that has his
// picture from when he stood there.
#pragma once

#include <span>

#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Sets in `mask` what lies between two parts one above the other, of the same columns, where the frame shows that both
// are of one thing: its sides go on from the one to the other. parts: the components of the mask with its gaps closed;
// every pair is looked at.
void join_fronts(GrayView frame, std::span<const Component> parts, MutableBitView mask);

}  // namespace cerberus::vision
