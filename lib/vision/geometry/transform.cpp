// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/transform.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// Determinant of the Jacobian of the projective map at p: det(M) / w^3.
double jacobian(const Transform& t, double determinant, Point p) {
  const double w = t.m[6] * p.x + t.m[7] * p.y + t.m[8];
  return determinant / (w * w * w);
}

double determinant(const std::array<double, 9>& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) +
         m[2] * (m[3] * m[7] - m[4] * m[6]);
}

std::array<Point, 4> corners(Size s) {
  const double r = s.width - 1, b = s.height - 1;
  return {Point{0, 0}, Point{r, 0}, Point{0, b}, Point{r, b}};
}

}  // namespace

Transform Transform::translation(double dx, double dy) {
  return {{1, 0, dx, 0, 1, dy, 0, 0, 1}};
}

bool Transform::is_identity() const {
  return m == Transform{}.m;
}

bool Transform::is_sane(Size picture) const {
  if (!std::all_of(m.begin(), m.end(), [](double v) { return std::isfinite(v); })) return false;
  const double det = determinant(m);
  return std::ranges::all_of(corners(picture), [&](Point p) {
    const double j = jacobian(*this, det, p);
    return j > 0.05 && j < 20.0;  // NaN fails both
  });
}

Transform Transform::inverse() const {
  const double det = determinant(m);
  if (det == 0 || !std::isfinite(det)) return {};
  std::array<double, 9> a{m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                          m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                          m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]};
  const double scale = a[8] != 0 ? a[8] : det;
  for (double& v : a) v /= scale;
  return {a};
}

Transform Transform::rescaled(Size from, Size to) const {
  const double sx = static_cast<double>(to.width) / from.width;
  const double sy = static_cast<double>(to.height) / from.height;
  if (is_identity()) return {};
  const Transform up{{sx, 0, 0.5 * sx - 0.5, 0, sy, 0.5 * sy - 0.5, 0, 0, 1}};
  const Transform down{{1 / sx, 0, 0.5 / sx - 0.5, 0, 1 / sy, 0.5 / sy - 0.5, 0, 0, 1}};
  return up * *this * down;
}

double Transform::corner_motion(Size picture) const {
  double farthest = 0;
  for (const Point p : corners(picture)) {
    const Point q = apply(p);
    farthest = std::max(farthest, std::hypot(q.x - p.x, q.y - p.y));
  }
  return farthest;
}

Transform operator*(const Transform& a, const Transform& b) {
  Transform c;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      c.m[i * 3 + j] = a.m[i * 3] * b.m[j] + a.m[i * 3 + 1] * b.m[3 + j] + a.m[i * 3 + 2] * b.m[6 + j];
  if (c.m[8] != 0 && c.m[8] != 1)
    for (const double w = c.m[8]; double& v : c.m) v /= w;
  return c;
}

}  // namespace cerberus::vision
