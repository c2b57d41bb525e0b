// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/box.h"

#include <algorithm>

namespace cerberus::vision {

Box inside(const Box& box, Size picture) {
  const double left = std::clamp<double>(box.x, 0, picture.width),
               top = std::clamp<double>(box.y, 0, picture.height);
  return {left, top, std::clamp<double>(box.right(), 0, picture.width) - left,
          std::clamp<double>(box.bottom(), 0, picture.height) - top};
}

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
