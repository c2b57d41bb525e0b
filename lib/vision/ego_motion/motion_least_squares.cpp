// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/motion_least_squares.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace cerberus::vision {

namespace {

// Standard deviations of the priors over the half diagonal. Origin unknown: kept from the first version. Guard:
// bench-camera_motion and tests/unit/motion_least_squares.
constexpr struct Parameters {
  double free = 10;     // of the shift: not limited
  double linear = 0.1;  // of zoom, roll and the rest of the linear part
  double bending =
      0.02;  // of the perspective part, and of the effect of a rolling shutter under acceleration
} kParameters;
constexpr double kFree = kParameters.free, kLinear = kParameters.linear, kBending = kParameters.bending;

}  // namespace

// One unknown of a model: its direction in the space of a homography's unknowns, and the standard deviation of its
// prior.
struct MotionLeastSquares::Unknown {
  double sigma;
  std::size_t first;
  double by = 1;
  std::size_t second = 0;
  double by_second = 0;
};

// Normal equations of N unknowns.
template <std::size_t N>
struct MotionLeastSquares::Normal {
  using Row = std::array<double, N>;
  std::array<Row, N> a{};  // upper triangle
  Row b{};

  Normal(std::span<const Unknown, N> unknowns, const MotionNormal& all, double scale) {
    const auto at = [&](std::size_t i, std::size_t j) { return i < j ? all.a[i][j] : all.a[j][i]; };
    for (std::size_t i = 0; i < N; ++i) {
      const Unknown& p = unknowns[i];
      for (std::size_t j = i; j < N; ++j) {
        const Unknown& q = unknowns[j];
        a[i][j] = p.by * (q.by * at(p.first, q.first) + q.by_second * at(p.first, q.second)) +
                  p.by_second * (q.by * at(p.second, q.first) + q.by_second * at(p.second, q.second));
      }
      a[i][i] += 1 / (p.sigma * p.sigma * scale * scale);
      b[i] = p.by * all.b[p.first] + p.by_second * all.b[p.second];
    }
  }

  // Cholesky; a becomes the factor. False when not positive definite.
  bool solve(Row& p) {
    for (std::size_t i = 0; i < N; ++i)
      for (std::size_t j = i; j < N; ++j) {
        double sum = a[i][j];
        for (std::size_t k = 0; k < i; ++k) sum -= a[k][i] * a[k][j];
        if (i == j) {
          if (!(sum > 1e-12)) return false;
          a[i][i] = std::sqrt(sum);
        } else {
          a[i][j] = sum / a[i][i];
        }
      }
    for (std::size_t i = 0; i < N; ++i) {
      double sum = b[i];
      for (std::size_t k = 0; k < i; ++k) sum -= a[k][i] * p[k];
      p[i] = sum / a[i][i];
    }
    for (std::size_t i = N; i-- > 0;) {
      double sum = p[i];
      for (std::size_t k = i + 1; k < N; ++k) sum -= a[i][k] * p[k];
      p[i] = sum / a[i][i];
    }
    return true;
  }
};

MotionLeastSquares::MotionLeastSquares(Size picture)
    : cx_(0.5 * (picture.width - 1)),
      cy_(0.5 * (picture.height - 1)),
      scale_(0.5 * std::hypot(picture.width, picture.height)) {}

Transform MotionLeastSquares::in_pixels(const Transform& scaled) const {
  const double per_scale = 1 / scale_;
  const Transform to{{per_scale, 0, -cx_ * per_scale, 0, per_scale, -cy_ * per_scale, 0, 0, 1}};
  const Transform from{{scale_, 0, cx_, 0, scale_, cy_, 0, 0, 1}};
  return from * scaled * to;
}

// With x, u about the middle, u - x = t + bend (t . x) u: solved for t (Sherman and Morrison).
Transform MotionLeastSquares::turn(Point from, Point to, double bend) const {
  const double x = (from.x - cx_) / scale_, y = (from.y - cy_) / scale_;
  const double u = (to.x - cx_) / scale_, v = (to.y - cy_) / scale_, dx = u - x, dy = v - y;
  const double along = bend * (x * dx + y * dy) / (1 + bend * (x * u + y * v));
  const double tx = dx - along * u, ty = dy - along * v;
  return in_pixels({{1, 0, tx, 0, 1, ty, -bend * tx, -bend * ty, 1}});
}

// Returns the transform of solved unknowns, which are relative to the half diagonal.
template <std::size_t N>
Transform MotionLeastSquares::composed(std::span<const Unknown, N> unknowns,
                                       const std::array<double, N>& values) const {
  std::array<double, MotionNormal::kUnknowns> p{};
  for (std::size_t i = 0; i < N; ++i) {
    p[unknowns[i].first] += unknowns[i].by * values[i];
    p[unknowns[i].second] += unknowns[i].by_second * values[i];
  }
  return in_pixels({{1 + p[2], p[3], p[0], p[4], 1 + p[5], p[1], p[6], p[7], 1}});
}

template <std::size_t N>
bool MotionLeastSquares::step(std::span<const Unknown, N> unknowns, const MotionNormal& all,
                              Transform& t) const {
  Normal<N> normal(unknowns, all, scale_);
  std::array<double, N> p;
  if (!normal.solve(p)) return false;
  for (double& v : p) v /= scale_;
  t = composed(unknowns, p);
  return true;
}

bool MotionLeastSquares::step(MotionModel model, const MotionNormal& normal, Transform& t) const {
  static constexpr std::array<Unknown, 2> kTranslation{{{kFree, 0}, {kFree, 1}}};
  static constexpr std::array<Unknown, 4> kSimilarity{
      {{kFree, 0}, {kFree, 1}, {kLinear, 2, 1, 5, 1}, {kLinear, 3, -1, 4, 1}}};
  static constexpr std::array<Unknown, 8> kHomography{{{kFree, 0},
                                                       {kFree, 1},
                                                       {kLinear, 2},
                                                       {kLinear, 3},
                                                       {kLinear, 4},
                                                       {kLinear, 5},
                                                       {kBending, 6},
                                                       {kBending, 7}}};
  switch (model) {
    case MotionModel::none:
      return false;
    case MotionModel::translation:
      return step(std::span(kTranslation), normal, t);
    case MotionModel::similarity:
      return step(std::span(kSimilarity), normal, t);
    case MotionModel::affine:
      return step(std::span(kHomography).first<6>(), normal, t);
    case MotionModel::homography:
      return step(std::span(kHomography), normal, t);
  }
  return false;
}

// Solves for a turned motion. The bend is the last unknown: the diagonal element of its row in Cholesky's factor is its
// information with the other unknowns marginalised.
template <std::size_t N>
bool MotionLeastSquares::step_turned(std::span<const Unknown, N> unknowns, const MotionNormal& all,
                                     LensBend& lens, Transform& t) const {
  Normal<N> normal(unknowns, all, scale_);
  const LensBend known = lens;
  normal.a[N - 1][N - 1] += known.information / (scale_ * scale_);
  normal.b[N - 1] += known.bend * known.information / scale_;
  std::array<double, N> p;
  if (!normal.solve(p)) return false;
  for (double& v : p) v /= scale_;
  const double information = normal.a[N - 1][N - 1] * normal.a[N - 1][N - 1] * scale_ * scale_;
  lens.information = std::max(information - known.information - 1 / (kMostBend * kMostBend), 0.0);
  if (lens.information > 0)
    lens.bend = (information * p[N - 1] - known.information * known.bend) / lens.information;
  p[N - 1] = std::clamp(p[N - 1], 0.0, kMostBend);
  t = composed(unknowns, p);
  return true;
}

bool MotionLeastSquares::step_turned(const MotionNormal& normal, Shutter shutter, LensBend& lens,
                                     Transform& t) const {
  const Point moved = t.apply({cx_, cy_});
  const double tx = (moved.x - cx_) / scale_, ty = (moved.y - cy_) / scale_;
  const Unknown x{kFree, 0}, y{kFree, 1}, zoom{kLinear, 2, 1, 5, 1}, roll{kLinear, 3, -1, 4, 1},
      shear{kBending, 3}, stretch{kBending, 5}, bend{kMostBend, 6, -tx, 7, -ty};
  if (shutter == Shutter::global) return step_turned<5>(std::array{x, y, zoom, roll, bend}, normal, lens, t);
  return step_turned<7>(std::array{x, y, zoom, roll, shear, stretch, bend}, normal, lens, t);
}

}  // namespace cerberus::vision
