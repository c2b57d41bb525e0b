// SPDX-License-Identifier: LGPL-2.1-or-later
// Plane-to-plane transforms: how a point of frame k-1 moves into frame k.
#pragma once

#include <array>

#include "vision/image/image.h"

namespace cerberus::vision {

struct Point {
  double x = 0;
  double y = 0;
};

// A 3x3 homography in row-major order, in pixels, pixel centres at whole numbers. The default is identity.
struct Transform {
  std::array<double, 9> m{1, 0, 0, 0, 1, 0, 0, 0, 1};

  static Transform translation(double dx, double dy);

  bool is_identity() const;
  bool is_affine() const { return m[6] == 0 && m[7] == 0 && m[8] == 1; }  // last row is 0 0 1
  // Returns whether all numbers are finite and the map keeps the orientation and is not degenerate: the determinant of
  // its Jacobian is positive at the picture's corners.
  bool is_sane(Size picture) const;
  Point apply(Point p) const {
    const double x = m[0] * p.x + m[1] * p.y + m[2], y = m[3] * p.x + m[4] * p.y + m[5];
    if (is_affine()) return {x, y};
    const double w = m[6] * p.x + m[7] * p.y + m[8];
    return {x / w, y / w};
  }
  // Returns identity for a singular transform: check is_sane() first.
  Transform inverse() const;
  // The same motion in a picture scaled from `from` to `to` pixels, pixel areas aligned at the top left corner
  // (x_to = (x_from + 0.5) * to / from - 0.5): analysis pixels to frame pixels and back.
  Transform rescaled(Size from, Size to) const;
  // Largest distance, in pixels, by which a corner of the picture moves.
  double corner_motion(Size picture) const;
};

// (a * b).apply(p) == a.apply(b.apply(p)), scaled so that m[8] == 1 where it is not 0.
Transform operator*(const Transform& a, const Transform& b);

}  // namespace cerberus::vision
