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

// The unknowns' factors are powers of a block's place, in half widths from the centre:
// u = p0 + p1 x + p2 y + x (p6 x + p7 y), v = p3 + p4 x + p5 y + y (p6 x + p7 y).
struct Power {
  int unknown, x, y;
};
constexpr std::array<Power, 5> kAcross{{{0, 0, 0}, {1, 1, 0}, {2, 0, 1}, {6, 2, 0}, {7, 1, 1}}};
constexpr std::array<Power, 5> kDown{{{3, 0, 0}, {4, 1, 0}, {5, 0, 1}, {6, 1, 1}, {7, 0, 2}}};

// Weighted sums over one row of blocks, times powers of x.
constexpr int kPowers = 5;
struct RowMoments {
  std::array<double, kPowers> xx{}, xy{}, yy{}, xe{}, ye{};

  void add(const BlockSums& b, double x, double weight) {
    const double quarter = 0.25 * weight, half = 0.5 * weight;  // of doubled gradients
    add(xx, kPowers, quarter * b.xx, x);
    add(xy, kPowers - 1, quarter * b.xy, x);
    add(yy, 3, quarter * b.yy, x);
    add(xe, 3, half * b.xe, x);
    add(ye, 2, half * b.ye, x);
  }

 private:
  static void add(std::array<double, kPowers>& sums, int powers, double value, double x) {
    for (int i = 0; i < powers; ++i, value *= x) sums[i] += value;
  }
};

// The same over all rows, [power of x][power of y].
struct Moments {
  using Sums = std::array<std::array<double, kPowers>, kPowers>;
  Sums xx{}, xy{}, yy{}, xe{}, ye{};

  void add(const RowMoments& row, double y) {
    add(xx, row.xx, y), add(xy, row.xy, y), add(yy, row.yy, y), add(xe, row.xe, y), add(ye, row.ye, y);
  }

 private:
  static void add(Sums& sums, const std::array<double, kPowers>& row, double y) {
    for (int i = 0; i < kPowers; ++i) {
      double value = row[i];
      for (int j = 0; i + j < kPowers; ++j, value *= y) sums[i][j] += value;
    }
  }
};

// J^T W J and -J^T W e.
System normal_equations(const Moments& moments) {
  System m{};
  for (const Power& i : kAcross) {
    for (const Power& j : kAcross) m[i.unknown][j.unknown] += moments.xx[i.x + j.x][i.y + j.y];
    for (const Power& j : kDown) {
      m[i.unknown][j.unknown] += moments.xy[i.x + j.x][i.y + j.y];
      m[j.unknown][i.unknown] += moments.xy[i.x + j.x][i.y + j.y];
    }
    m[i.unknown][kUnknowns] -= moments.xe[i.x][i.y];
  }
  for (const Power& i : kDown) {
    for (const Power& j : kDown) m[i.unknown][j.unknown] += moments.yy[i.x + j.x][i.y + j.y];
    m[i.unknown][kUnknowns] -= moments.ye[i.x][i.y];
  }
  return m;
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
    Moments moments;
    for (std::size_t first = 0; first + across <= blocks.size(); first += across) {
      RowMoments row;
      const double y = place(first / across, cy);
      const double u0 = p[0] + y * p[2], u1 = p[1] + y * p[7], u2 = p[6];
      const double v0 = p[3] + y * (p[5] + y * p[7]), v1 = p[4] + y * p[6];
      for (std::size_t bx = 0; bx < across; ++bx) {
        const BlockSums& b = blocks[first + bx];
        if (b.n < kParameters.least_pixels) continue;
        const double x = place(bx, cx);
        // The sums hold doubled gradients: half the displacement goes with them.
        const double u = 0.5 * (u0 + x * (u1 + x * u2)), v = 0.5 * (v0 + x * v1);
        const double left = b.ee + u * (2.0 * b.xe + u * b.xx + 2 * v * b.xy) + v * (2.0 * b.ye + v * b.yy);
        const double cauchy = b.n / (kParameters.scale * b.n + std::max(left, 0.0));
        row.add(b, x, cauchy * cauchy);
      }
      moments.add(row, y);
    }
    System m = normal_equations(moments);
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
