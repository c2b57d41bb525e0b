// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/motion_least_squares.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// (half diagonal / focal length)^2 of a lens of 110 degrees: wider ones are no longer plane.
constexpr double kMostBend = 3.2;

using Distances = std::array<float, MotionSamples::kMax>;

// Normal equations of N unknowns.
template <int N>
struct Normal {
  using Row = std::array<double, N>;
  std::array<Row, N> a{};  // upper triangle
  Row b{};

  // Adds the measurement J p = d (two rows) with the 2x2 weight W.
  void add(const Row& jx, const Row& jy, double dx, double dy, double wxx, double wxy, double wyy) {
    for (int i = 0; i < N; ++i) {
      const double ex = jx[i] * wxx + jy[i] * wxy, ey = jx[i] * wxy + jy[i] * wyy;
      for (int j = i; j < N; ++j) a[i][j] += ex * jx[j] + ey * jy[j];
      b[i] += ex * dx + ey * dy;
    }
  }

  // Cholesky. False when not positive definite.
  bool solve(Row& p) {
    for (int i = 0; i < N; ++i)
      for (int j = i; j < N; ++j) {
        double sum = a[i][j];
        for (int k = 0; k < i; ++k) sum -= a[k][i] * a[k][j];
        if (i == j) {
          if (!(sum > 1e-12)) return false;
          a[i][i] = std::sqrt(sum);
        } else {
          a[i][j] = sum / a[i][i];
        }
      }
    for (int i = 0; i < N; ++i) {
      double sum = b[i];
      for (int k = 0; k < i; ++k) sum -= a[k][i] * p[k];
      p[i] = sum / a[i][i];
    }
    for (int i = N - 1; i >= 0; --i) {
      double sum = p[i];
      for (int k = i + 1; k < N; ++k) sum -= a[i][k] * p[k];
      p[i] = sum / a[i][i];
    }
    return true;
  }
};

}  // namespace

MotionLeastSquares::MotionLeastSquares(Size picture)
    : cx_(0.5 * (picture.width - 1)),
      cy_(0.5 * (picture.height - 1)),
      scale_(0.5 * std::hypot(picture.width, picture.height)) {}

template <int N, typename Design, typename Compose>
bool MotionLeastSquares::solve(const MotionSamples& s, const Distances& weights, Transform& t,
                               Design&& design, Compose&& compose) const {
  Normal<N> normal;
  for (int i = 0; i < N;
       ++i) {  // priors: shift free, linear part 10 % of the scale, perspective 3 %, bend any lens
    const double sigma = (i < 2 ? 10.0 : N == 5 && i == 4 ? kMostBend : i < 6 ? 0.1 : 0.03) * scale_;
    normal.a[i][i] = 1 / (sigma * sigma);
  }
  std::array<double, N> jx, jy, p{};
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
  const Transform to{{per_scale, 0, -cx_ * per_scale, 0, per_scale, -cy_ * per_scale, 0, 0, 1}};
  const Transform from{{scale_, 0, cx_, 0, scale_, cy_, 0, 0, 1}};
  t = from * compose(p) * to;
  return true;
}

bool MotionLeastSquares::step(MotionModel model, const MotionSamples& s, const Distances& weights,
                              Transform& t) const {
  using Row2 = std::array<double, 2>;
  using Row4 = std::array<double, 4>;
  using Row6 = std::array<double, 6>;
  using Row8 = std::array<double, 8>;
  switch (model) {
    case MotionModel::none:
      return false;
    case MotionModel::translation:
      return solve<2>(
          s, weights, t, [](double, double, double, double, Row2& jx, Row2& jy) { jx = {1, 0}, jy = {0, 1}; },
          [](const Row2& p) { return Transform{{1, 0, p[0], 0, 1, p[1], 0, 0, 1}}; });
    case MotionModel::similarity:
      return solve<4>(
          s, weights, t,
          [](double X, double Y, double, double, Row4& jx, Row4& jy) {
            jx = {1, 0, X, -Y}, jy = {0, 1, Y, X};
          },
          [](const Row4& p) { return Transform{{1 + p[2], -p[3], p[0], p[3], 1 + p[2], p[1], 0, 0, 1}}; });
    case MotionModel::affine:
      return solve<6>(
          s, weights, t,
          [](double X, double Y, double, double, Row6& jx, Row6& jy) {
            jx = {1, 0, X, Y, 0, 0}, jy = {0, 1, 0, 0, X, Y};
          },
          [](const Row6& p) { return Transform{{1 + p[2], p[3], p[0], p[4], 1 + p[5], p[1], 0, 0, 1}}; });
    case MotionModel::homography:
      return solve<8>(
          s, weights, t,
          [](double X, double Y, double U, double V, Row8& jx, Row8& jy) {
            jx = {1, 0, X, Y, 0, 0, -X * U, -Y * U}, jy = {0, 1, 0, 0, X, Y, -X * V, -Y * V};
          },
          [](const Row8& p) {
            return Transform{{1 + p[2], p[3], p[0], p[4], 1 + p[5], p[1], p[6], p[7], 1}};
          });
  }
  return false;
}

bool MotionLeastSquares::step_turned(const MotionSamples& s, const Distances& weights, Transform& t) const {
  using Row5 = std::array<double, 5>;
  const Point moved = t.apply({cx_, cy_});
  const double tx = (moved.x - cx_) / scale_, ty = (moved.y - cy_) / scale_;
  return solve<5>(
      s, weights, t,
      [&](double X, double Y, double U, double V, Row5& jx, Row5& jy) {
        const double along = tx * X + ty * Y;
        jx = {1, 0, X, -Y, along * U}, jy = {0, 1, Y, X, along * V};
      },
      [&](const Row5& p) {
        const double bend = std::clamp(p[4], 0.0, kMostBend);
        return Transform{{1 + p[2], -p[3], p[0], p[3], 1 + p[2], p[1], -bend * tx, -bend * ty, 1}};
      });
}

}  // namespace cerberus::vision
