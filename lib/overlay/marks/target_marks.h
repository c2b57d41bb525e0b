// SPDX-License-Identifier: LGPL-2.1-or-later
// The brackets round the box of the object that the head follows.
#pragma once

#include <vector>

#include "overlay/color.h"
#include "overlay/picture.h"
#include "overlay/scene.h"

namespace cerberus::overlay {

// Distance of the brackets from the box, in widths of its line.
inline constexpr double kTargetRoom = 2.5;

// Appends a patch for each corner: outside the box and thicker than its line, which is `line` pixels wide; clipped to
// the frame.
void draw_target_marks(const Object& object, double line, Area frame, PicturePool& pool,
                       std::vector<Patch>& patches);

}  // namespace cerberus::overlay
