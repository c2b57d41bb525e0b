// SPDX-License-Identifier: LGPL-2.1-or-later
// An upright rectangle around an object.
#pragma once

#include "vision/geometry/transform.h"

namespace cerberus::vision {

struct Box {
  double x = 0, y = 0, width = 0, height = 0;  // top left corner and extent, pixels
  double right() const { return x + width; }
  double bottom() const { return y + height; }
  double area() const { return width * height; }
};
inline Point centre(const Box& b) {
  return {b.x + b.width / 2, b.y + b.height / 2};
}
// The part that lies in a picture of this size; of no area where there is none.
Box inside(const Box& box, Size picture);
// The part around the box's middle that has these shares of its width and height.
Box core_of(const Box& box, double width, double height);
double overlap_area(const Box& a, const Box& b);
// Of the box's area, that which lies in the other one; 0 of an empty box.
double share_within(const Box& box, const Box& outer);
double intersection_over_union(const Box& a, const Box& b);

}  // namespace cerberus::vision
