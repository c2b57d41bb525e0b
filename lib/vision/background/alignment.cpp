// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr int kUnknowns = 8;
// Origin unknown: kept from the first version. Guard of all: unit-alignment and mean F of bench-quality.
constexpr struct Parameters {
  int rounds = 3;                        // of reweighting
  int least_pixels = 16;                 // of a block that counts
  double scale = 4;                      // squared grey levels: of the Cauchy weight
  double smallest = 0.04, largest = 12;  // pixels at the corners: of a correction
  double damping = 1e-3;              // of the strongest diagonal element, added to the affine unknowns' ...
  double perspective_damping = 3e-3;  // ... and to the perspective ones'
} kParameters;
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

// Adds a block's share of J^T W J and, in the last column, of -J^T W e. x, y: its place in half widths from the centre:
// u = p0 + p1 x + p2 y + x (p6 x + p7 y), v = p3 + p4 x + p5 y + y (p6 x + p7 y).
void add(System& m, const BlockSums& b, double weight, double x, double y) {
  const Solution across{1, x, y, 0, 0, 0, x * x, x * y}, down{0, 0, 0, 1, x, y, x * y, y * y};
  const double quarter = 0.25 * weight, half = 0.5 * weight;  // of doubled gradients
  for (int i = 0; i < kUnknowns; ++i) {
    const double by_u = quarter * (b.xx * across[i] + b.xy * down[i]),
                 by_v = quarter * (b.xy * across[i] + b.yy * down[i]);
    for (int j = 0; j < kUnknowns; ++j) m[i][j] += by_u * across[j] + by_v * down[j];
    m[i][kUnknowns] -= half * (b.xe * across[i] + b.ye * down[i]);
  }
}

}  // namespace

std::optional<Transform> align_to_background(std::span<const BlockSums> blocks, int columns, Size picture) {
  const double cx = (picture.width - 1) / 2.0, cy = (picture.height - 1) / 2.0, unit = picture.width / 2.0;
  const double per_unit = 1 / unit;
  const auto place = [&](std::size_t block, double centre) {
    return (static_cast<double>(block) * kBackgroundBlock + (kBackgroundBlock - 1) / 2.0 - centre) * per_unit;
  };
  const std::size_t across = static_cast<std::size_t>(columns);
  Solution p{};
  for (int round = 0; round < kParameters.rounds; ++round) {
    System m{};
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      const BlockSums& b = blocks[i];
      if (b.n < kParameters.least_pixels) continue;
      const double x = place(i % across, cx), y = place(i / across, cy);
      // The sums hold doubled gradients: half the displacement goes with them.
      const double bend = x * p[6] + y * p[7];
      const double u = 0.5 * (p[0] + x * (p[1] + bend) + y * p[2]),
                   v = 0.5 * (p[3] + x * p[4] + y * (p[5] + bend));
      const double left = b.ee + u * (2.0 * b.xe + u * b.xx + 2 * v * b.xy) + v * (2.0 * b.ye + v * b.yy);
      const double cauchy = b.n / (kParameters.scale * b.n + std::max(left, 0.0));
      add(m, b, cauchy * cauchy, x, y);
    }
    double strongest = 0;
    for (int i = 0; i < kUnknowns; ++i) strongest = std::max(strongest, m[i][i]);
    for (int i = 0; i < kUnknowns; ++i)
      // Unknowns that the picture does not determine stay 0.
      m[i][i] += (i < 6 ? kParameters.damping : kParameters.perspective_damping) * strongest + 1e-9;
    p = solve(m);
  }
  for (const int i : {1, 2, 4, 5}) p[i] /= unit;
  for (const int i : {6, 7}) p[i] /= unit * unit;
  const Transform about_centre{{1 + p[1], p[2], p[0], p[4], 1 + p[5], p[3], -p[6], -p[7], 1}};
  const Transform c = Transform::translation(cx, cy) * about_centre * Transform::translation(-cx, -cy);
  const double reach = c.corner_motion(picture);
  if (!(reach >= kParameters.smallest && reach <= kParameters.largest) || !c.is_sane(picture))
    return std::nullopt;
  return c;
}

}  // namespace cerberus::vision
