// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/evidence/sparse_flow.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

constexpr int kRadius = 5, kSide = 2 * kRadius + 1;  // of the window, pixels
constexpr int kWide = kSide + 2;                     // with a border for the gradients

// Bilinear samples of side x side pixels around `at`. False: they leave the picture.
template <int side>
bool sample(GrayView picture, Point at, float* out) {
  const double left = at.x - side / 2, top = at.y - side / 2;
  if (!(left >= 0 && top >= 0)) return false;
  const int x = static_cast<int>(left), y = static_cast<int>(top);
  if (x + side >= picture.width || y + side >= picture.height) return false;
  const float fx = static_cast<float>(left - x), fy = static_cast<float>(top - y);
  const float a = (1 - fx) * (1 - fy), b = fx * (1 - fy), c = (1 - fx) * fy, d = fx * fy;
  for (int j = 0; j < side; ++j) {
    const std::uint8_t *p = picture.row(y + j) + x, *q = picture.row(y + j + 1) + x;
    for (int i = 0; i < side; ++i) out[j * side + i] = a * p[i] + b * p[i + 1] + c * q[i] + d * q[i + 1];
  }
  return true;
}

struct Window {
  float grey[kSide * kSide], across[kSide * kSide], down[kSide * kSide];
  double xx = 0, xy = 0, yy = 0;
};

bool make_window(GrayView picture, Point at, double least_edge, Window& window) {
  float wide[kWide * kWide];
  if (!sample<kWide>(picture, at, wide)) return false;
  float xx = 0, xy = 0, yy = 0;
  for (int j = 0; j < kSide; ++j) {
    const float* row = wide + (j + 1) * kWide + 1;
    for (int i = 0; i < kSide; ++i) {
      const float gx = .5f * (row[i + 1] - row[i - 1]), gy = .5f * (row[i + kWide] - row[i - kWide]);
      window.grey[j * kSide + i] = row[i];
      window.across[j * kSide + i] = gx;
      window.down[j * kSide + i] = gy;
      xx += gx * gx, xy += gx * gy, yy += gy * gy;
    }
  }
  window.xx = xx, window.xy = xy, window.yy = yy;
  const double middle = .5 * (window.xx + window.yy);
  const double smaller = middle - std::hypot(.5 * (window.xx - window.yy), window.xy);
  return smaller > least_edge * kSide * kSide;
}

}  // namespace

std::optional<Point> follow_point(const Pyramid& before, const Pyramid& now, Point at, Point guess,
                                  const SparseFlowParameters& p) {
  Point shift{guess.x - at.x, guess.y - at.y};
  const int top = std::min({p.levels, before.levels(), now.levels()}) - 1;
  bool found = false;
  for (int level = top; level >= 0; --level) {
    const double scale = 1.0 / (1 << level);
    const Point here{(at.x + .5) * scale - .5, (at.y + .5) * scale - .5};
    Window window;
    if (!make_window(before.level(level), here, p.least_edge, window)) {
      if (level == 0) return std::nullopt;
      continue;
    }
    const double determinant = window.xx * window.yy - window.xy * window.xy;
    Point d{shift.x * scale, shift.y * scale};
    found = false;
    for (int i = 0; i < p.iterations; ++i) {
      float grey[kSide * kSide];
      if (!sample<kSide>(now.level(level), {here.x + d.x, here.y + d.y}, grey)) break;
      float bx = 0, by = 0;
      for (int k = 0; k < kSide * kSide; ++k) {
        const float e = grey[k] - window.grey[k];
        bx += e * window.across[k], by += e * window.down[k];
      }
      const double dx = (window.yy * bx - window.xy * by) / determinant;
      const double dy = (window.xx * by - window.xy * bx) / determinant;
      d.x -= dx, d.y -= dy;
      found = true;
      if (std::abs(dx) + std::abs(dy) < p.step) break;
    }
    if (found) shift = {d.x / scale, d.y / scale};
  }
  if (!found || !std::isfinite(shift.x + shift.y)) return std::nullopt;
  return Point{at.x + shift.x, at.y + shift.y};
}

}  // namespace cerberus::vision
