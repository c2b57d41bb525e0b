// SPDX-License-Identifier: LGPL-2.1-or-later
// Objects that fall apart into fragments one above the other. A person who walks straight up or down the picture, or
// towards the camera, differs from the frame before only at head, waist and feet: the even parts between them do not
// change, nor do they differ from a background model that was learnt while he stood there.
#pragma once

#include <span>

#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Sets in `mask` the gap between two components one above the other, of the same columns, where the frame shows that
// both belong to one object: its sides continue from one to the other. components: those of the mask with its gaps
// closed; every pair is tried.
void join_fragments(GrayView frame, std::span<const Component> components, MutableBitView mask);

}  // namespace cerberus::vision
