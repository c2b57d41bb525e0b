// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/box.h"

#include <algorithm>

namespace cerberus::vision {

Box core_of(const Box& box, double width, double height) {
  return {box.x + box.width * (1 - width) / 2, box.y + box.height * (1 - height) / 2, box.width * width,
          box.height * height};
}

double overlap_area(const Box& a, const Box& b) {
  const double w = std::min(a.right(), b.right()) - std::max(a.x, b.x);
  const double h = std::min(a.bottom(), b.bottom()) - std::max(a.y, b.y);
  return w > 0 && h > 0 ? w * h : 0;
}

double share_within(const Box& box, const Box& outer) {
  return box.area() > 0 ? overlap_area(box, outer) / box.area() : 0;
}

double intersection_over_union(const Box& a, const Box& b) {
  const double both = overlap_area(a, b);
  return both > 0 ? both / (a.area() + b.area() - both) : 0;
}

}  // namespace cerberus::vision
