// SPDX-License-Identifier: LGPL-2.1-or-later
// What the left and right sides of a component tell: is the gap between two of them the inside of one moving object, or the
// background between two? Is a side an object's, or an edge of the scene?
#pragma once

#include <cstddef>
#include <span>

#include "vision/components/visible_columns.h"
#include "vision/image/image.h"
#include "vision/image/labelling.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

struct Gap {  // columns and rows of the picture, `right` and `bottom` exclusive
  int left, top, right, bottom;
};

struct Rows {  // `bottom` exclusive
  int top, bottom;
};

// Returns whether the gap may be the inside of a moving object: only an even inside differs from nothing. A gap that is
// uneven over as many pixels as the object would have moved (`moved`, the components' width) and has not changed is
// background between two objects.
bool is_even(GrayView frame, const Gap& gap, int moved);

// Returns whether the left or right side of a component is, in these rows, an edge of the frame and none of the
// background: the side of an object. The rim by which an object has moved on ends in the object, where the frame is even;
// the rim that it left ends where the object was, and that edge is in the background. True also at the edge of what is
// visible, where nothing can be compared. background: the model's picture, under the frame's light. runs: of all components.
bool is_side_of_object(GrayView frame, GrayView background, const VisibleColumns& visible,
                       std::span<const Run> runs, std::size_t component, bool right, const Rows& rows);

// Returns whether both sides of a component are edges of the scene: they go on in the frame above or below it, for a quarter
// of its height and 4 rows at least. Of a side at the edge of what is visible, where nothing can be compared, this is not
// known: false. What a door frame cuts out of the place that somebody left has such sides. mask: the foreground.
bool sides_go_on(GrayView frame, const VisibleColumns& visible, BitView mask, std::span<const Run> runs,
                 std::size_t component);

}  // namespace cerberus::vision
