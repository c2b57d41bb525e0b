// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/scene_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr int kUnknowns = 8;
constexpr int kRounds = 3;
constexpr int kLeastPixels = 16;                   // of a block
constexpr double kScale = 4;                       // squared grey levels
constexpr double kSmallest = 0.04, kLargest = 12;  // pixels at the corners
using System = std::array<std::array<double, kUnknowns + 1>, kUnknowns>;
using Solution = std::array<double, kUnknowns>;

// Gaussian elimination with row pivoting; the matrix is regularised, so it is never singular.
Solution solve(System& m) {
  for (int i = 0; i < kUnknowns; ++i) {
    int pivot = i;
    for (int j = i + 1; j < kUnknowns; ++j)
      if (std::abs(m[j][i]) > std::abs(m[pivot][i])) pivot = j;
    std::swap(m[i], m[pivot]);
    for (int j = i + 1; j < kUnknowns; ++j) {
      const double k = m[j][i] / m[i][i];
      for (int l = i; l <= kUnknowns; ++l) m[j][l] -= k * m[i][l];
    }
  }
  Solution p{};
  for (int i = kUnknowns - 1; i >= 0; --i) {
    double t = m[i][kUnknowns];
    for (int j = i + 1; j < kUnknowns; ++j) t -= m[i][j] * p[j];
    p[i] = t / m[i][i];
  }
  return p;
}

}  // namespace

std::optional<Transform> align_to_memory(std::span<const BlockSums> blocks, int columns, Size picture) {
  // Positions in half widths from the centre. u = p0 + p1 x + p2 y + x (p6 x + p7 y), v = p3 + p4 x + p5 y + y (...).
  const double cx = (picture.width - 1) / 2.0, cy = (picture.height - 1) / 2.0, unit = picture.width / 2.0;
  Solution p{};
  for (int round = 0; round < kRounds; ++round) {
    System m{};
    for (std::size_t index = 0; index < blocks.size(); ++index) {
      const BlockSums& b = blocks[index];
      if (b.n < kLeastPixels) continue;
      const int bx = static_cast<int>(index) % columns, by = static_cast<int>(index) / columns;
      const double x = (bx * kSceneBlock + (kSceneBlock - 1) / 2.0 - cx) / unit;
      const double y = (by * kSceneBlock + (kSceneBlock - 1) / 2.0 - cy) / unit;
      const std::array<double, kUnknowns> ju{1, x, y, 0, 0, 0, x * x, x * y},
          jv{0, 0, 0, 1, x, y, x * y, y * y};
      double u = 0, v = 0;
      for (int i = 0; i < kUnknowns; ++i) u += ju[i] * p[i], v += jv[i] * p[i];
      // The sums hold doubled gradients.
      const double xx = b.xx / 4.0, xy = b.xy / 4.0, yy = b.yy / 4.0, xe = b.xe / 2.0, ye = b.ye / 2.0;
      const double left = b.ee + 2 * (u * xe + v * ye) + u * u * xx + 2 * u * v * xy + v * v * yy;
      const double cauchy = 1 / (kScale + std::max(left, 0.0) / b.n), weight = cauchy * cauchy;
      // J^T W J; the three zeros in the middle of ju and at the beginning of jv are not multiplied.
      const auto add = [&](int from, int to, int i, const auto& term) {
        for (int j = from; j < to; ++j) m[i][j] += term(j);
      };
      for (int i = 0; i < kUnknowns; ++i) {
        const double sx = weight * (xx * ju[i] + xy * jv[i]), sy = weight * (xy * ju[i] + yy * jv[i]);
        add(0, std::min(i + 1, 3), i, [&](int j) { return ju[j] * sx; });
        add(3, std::min(i + 1, 6), i, [&](int j) { return jv[j] * sy; });
        add(6, i + 1, i, [&](int j) { return ju[j] * sx + jv[j] * sy; });
        m[i][kUnknowns] -= weight * (ju[i] * xe + jv[i] * ye);
      }
    }
    double strongest = 0;
    for (int i = 0; i < kUnknowns; ++i) strongest = std::max(strongest, m[i][i]);
    for (int i = 0; i < kUnknowns; ++i) {
      for (int j = i + 1; j < kUnknowns; ++j) m[i][j] = m[j][i];
      m[i][i] += (i < 6 ? 1e-3 : 3e-3) * strongest + 1e-9;  // what the picture does not tell stays 0
    }
    p = solve(m);
  }
  for (const int i : {1, 2, 4, 5}) p[i] /= unit;
  for (const int i : {6, 7}) p[i] /= unit * unit;
  const Transform about_centre{{1 + p[1], p[2], p[0], p[4], 1 + p[5], p[3], -p[6], -p[7], 1}};
  const Transform c = Transform::translation(cx, cy) * about_centre * Transform::translation(-cx, -cy);
  const double reach = c.corner_motion(picture);
  if (!(reach >= kSmallest && reach <= kLargest) || !c.is_sane(picture)) return std::nullopt;
  return c;
}

}  // namespace cerberus::vision
