// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/motion_least_squares.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// Priors, standard deviations over the half diagonal: shift free, linear part 10 %, perspective 3 %, what a rolling
// shutter makes of a jerk 2 %.
constexpr double kFree = 10, kLinear = 0.1, kPerspective = 0.03, kRolling = 0.02;

using Distances = std::array<float, MotionSamples::kMax>;

}  // namespace

// Normal equations of N unknowns.
template <std::size_t N>
struct MotionLeastSquares::Normal {
  using Row = std::array<double, N>;
  std::array<Row, N> a{};  // upper triangle
  Row b{};

  void expect(std::size_t unknown, double sigma) { a[unknown][unknown] += 1 / (sigma * sigma); }

  // Adds the measurement J p = d (two rows) with the 2x2 weight W.
  void add(const Row& jx, const Row& jy, double dx, double dy, double wxx, double wxy, double wyy) {
    for (std::size_t i = 0; i < N; ++i) {
      const double ex = jx[i] * wxx + jy[i] * wxy, ey = jx[i] * wxy + jy[i] * wyy;
      for (std::size_t j = i; j < N; ++j) a[i][j] += ex * jx[j] + ey * jy[j];
      b[i] += ex * dx + ey * dy;
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

// The unknowns come out over the half diagonal.
template <std::size_t N, typename Design>
bool MotionLeastSquares::solve(const MotionSamples& s, const Distances& weights, Normal<N>& normal,
                               std::array<double, N>& p, Design&& design) const {
  std::array<double, N> jx, jy;
  const double per_scale = 1 / scale_;
  for (int i = 0; i < s.count; ++i) {
    const double w = weights[i];
    if (!(w > 0)) continue;
    design((s.x[i] - cx_) * per_scale, (s.y[i] - cy_) * per_scale, (s.u[i] - cx_) * per_scale,
           (s.v[i] - cy_) * per_scale, jx, jy);
    normal.add(jx, jy, s.u[i] - s.x[i], s.v[i] - s.y[i], w * s.wxx[i], w * s.wxy[i], w * s.wyy[i]);
  }
  if (!normal.solve(p)) return false;
  for (double& v : p) v *= per_scale;
  return true;
}

bool MotionLeastSquares::step(MotionModel model, const MotionSamples& s, const Distances& weights,
                              Transform& t) const {
  const auto with = [&]<std::size_t N>(std::array<double, N> p, auto&& design, auto&& compose) {
    Normal<N> normal;
    for (std::size_t i = 0; i < N; ++i)
      normal.expect(i, (i < 2 ? kFree : i < 6 ? kLinear : kPerspective) * scale_);
    if (!solve(s, weights, normal, p, design)) return false;
    t = in_pixels(compose(p));
    return true;
  };
  using Row2 = std::array<double, 2>;
  using Row4 = std::array<double, 4>;
  using Row6 = std::array<double, 6>;
  using Row8 = std::array<double, 8>;
  switch (model) {
    case MotionModel::none:
      return false;
    case MotionModel::translation:
      return with(
          Row2{}, [](double, double, double, double, Row2& jx, Row2& jy) { jx = {1, 0}, jy = {0, 1}; },
          [](const Row2& p) { return Transform{{1, 0, p[0], 0, 1, p[1], 0, 0, 1}}; });
    case MotionModel::similarity:
      return with(
          Row4{},
          [](double X, double Y, double, double, Row4& jx, Row4& jy) {
            jx = {1, 0, X, -Y}, jy = {0, 1, Y, X};
          },
          [](const Row4& p) { return Transform{{1 + p[2], -p[3], p[0], p[3], 1 + p[2], p[1], 0, 0, 1}}; });
    case MotionModel::affine:
      return with(
          Row6{},
          [](double X, double Y, double, double, Row6& jx, Row6& jy) {
            jx = {1, 0, X, Y, 0, 0}, jy = {0, 1, 0, 0, X, Y};
          },
          [](const Row6& p) { return Transform{{1 + p[2], p[3], p[0], p[4], 1 + p[5], p[1], 0, 0, 1}}; });
    case MotionModel::homography:
      return with(
          Row8{},
          [](double X, double Y, double U, double V, Row8& jx, Row8& jy) {
            jx = {1, 0, X, Y, 0, 0, -X * U, -Y * U}, jy = {0, 1, 0, 0, X, Y, -X * V, -Y * V};
          },
          [](const Row8& p) {
            return Transform{{1 + p[2], p[3], p[0], p[4], 1 + p[5], p[1], p[6], p[7], 1}};
          });
  }
  return false;
}

bool MotionLeastSquares::step_turned(const MotionSamples& s, const Distances& weights, Shutter shutter,
                                     LensBend& lens, Transform& t) const {
  // The bend is the last unknown: what remains in its row of Cholesky's factor is what is known of it when the others
  // are not.
  const Point moved = t.apply({cx_, cy_});
  const double tx = (moved.x - cx_) / scale_, ty = (moved.y - cy_) / scale_;
  const auto with = [&]<std::size_t N>(std::array<double, N> p, auto&& design, auto&& linear) {
    Normal<N> normal;
    for (std::size_t i = 0; i < N - 1; ++i)
      normal.expect(i, (i < 2 ? kFree : i < 4 ? kLinear : kRolling) * scale_);
    normal.expect(N - 1, kMostBend * scale_);
    const LensBend known = lens;
    normal.a[N - 1][N - 1] += known.information / (scale_ * scale_);
    normal.b[N - 1] = known.bend * known.information / scale_;
    const auto bending = [&](double X, double Y, double U, double V, auto& jx, auto& jy) {
      design(X, Y, jx, jy);
      jx[N - 1] = (tx * X + ty * Y) * U, jy[N - 1] = (tx * X + ty * Y) * V;
    };
    if (!solve(s, weights, normal, p, bending)) return false;
    const double information = normal.a[N - 1][N - 1] * normal.a[N - 1][N - 1] * scale_ * scale_;
    lens.information = std::max(information - known.information - 1 / (kMostBend * kMostBend), 0.0);
    if (lens.information > 0)
      lens.bend = (information * p[N - 1] - known.information * known.bend) / lens.information;
    const double bend = std::clamp(p[N - 1], 0.0, kMostBend);
    Transform scaled = linear(p);
    scaled.m[6] = -bend * tx, scaled.m[7] = -bend * ty;
    t = in_pixels(scaled);
    return true;
  };
  using Row5 = std::array<double, 5>;
  using Row7 = std::array<double, 7>;
  if (shutter == Shutter::global)
    return with(
        Row5{}, [](double X, double Y, Row5& jx, Row5& jy) { jx = {1, 0, X, -Y}, jy = {0, 1, Y, X}; },
        [](const Row5& p) { return Transform{{1 + p[2], -p[3], p[0], p[3], 1 + p[2], p[1], 0, 0, 1}}; });
  return with(
      Row7{},
      [](double X, double Y, Row7& jx, Row7& jy) { jx = {1, 0, X, -Y, Y, 0}, jy = {0, 1, Y, X, 0, Y}; },
      [](const Row7& p) {
        return Transform{{1 + p[2], p[4] - p[3], p[0], p[3], 1 + p[2] + p[5], p[1], 0, 0, 1}};
      });
}

}  // namespace cerberus::vision
