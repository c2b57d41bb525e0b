// SPDX-License-Identifier: LGPL-2.1-or-later
// The brackets round the box of the object that the head follows.
#pragma once

#include <vector>

#include "overlay/color.h"
#include "overlay/picture.h"
#include "overlay/scene.h"

namespace cerberus::overlay {

// How far the brackets lie outside the box, in widths of its line.
inline constexpr double kTargetRoom = 2.5;

// Appends a patch a corner: thicker than the box's line, `line` pixels wide, and round the box; within the frame where
// that ends there.
void draw_target_marks(const Object& object, double line, Area frame, PicturePool& pool,
                       std::vector<Patch>& patches);

}  // namespace cerberus::overlay
