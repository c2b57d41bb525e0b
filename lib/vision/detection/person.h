// SPDX-License-Identifier: LGPL-2.1-or-later
// A standing person that explains foreground, and the part of the picture that is searched for persons.
#pragma once

#include "vision/geometry/box.h"

namespace cerberus::vision {

// Part of the picture: columns and rows from (left, top) up to but not including (right, bottom).
struct Bounds {
  int left = 0, top = 0, right = 0, bottom = 0;
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

struct Person {
  Box box;           // of the body's height and usual width, its axis in the middle; may leave the picture
  double score = 0;  // log-likelihood ratio a pixel of the body; about 1 for a whole person with a good mask
};

}  // namespace cerberus::vision
