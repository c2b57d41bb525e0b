// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

#include "vision/geometry/transform.h"

namespace cerberus::tests {

// Rotation by `angle` radians (x towards y) and scaling about the origin, then the translation.
inline vision::Transform similarity(double scale, double angle, double dx, double dy) {
  const double c = scale * std::cos(angle), s = scale * std::sin(angle);
  return {{c, -s, dx, s, c, dy, 0, 0, 1}};
}

}  // namespace cerberus::tests
