// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/motion_fit.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace cerberus::vision {

namespace {

// Widths of Tukey's weights in the rounds of refinement, in gates: wide first, as the start may be a simpler model.
constexpr std::array kGates{6.0f, 3.0f, 1.5f, 1.5f, 1.5f};

using Distances = std::array<float, MotionSamples::kMax>;

// Squared Mahalanobis distance of every sample from the transform.
void measure(const MotionSamples& s, const Transform& t, Distances& distances) {
  std::array<float, 9> m;
  for (int i = 0; i < 9; ++i) m[i] = static_cast<float>(t.m[i]);
  const auto square = [&](int i, float dx, float dy) {
    return s.wxx[i] * dx * dx + 2 * s.wxy[i] * dx * dy + s.wyy[i] * dy * dy;
  };
  if (t.is_affine()) {
    for (int i = 0; i < s.count; ++i)
      distances[i] = square(i, s.u[i] - (m[0] * s.x[i] + m[1] * s.y[i] + m[2]),
                            s.v[i] - (m[3] * s.x[i] + m[4] * s.y[i] + m[5]));
  } else {
    for (int i = 0; i < s.count; ++i) {
      const float w = 1.0f / (m[6] * s.x[i] + m[7] * s.y[i] + m[8]);
      distances[i] = square(i, s.u[i] - (m[0] * s.x[i] + m[1] * s.y[i] + m[2]) * w,
                            s.v[i] - (m[3] * s.x[i] + m[4] * s.y[i] + m[5]) * w);
    }
  }
}

double support_of(const MotionSamples& s, const Distances& distances) {
  std::array<float, MotionSamples::kRegions> regions{};
  for (int i = 0; i < s.count; ++i)
    regions[s.region[i]] += s.evidence[i] * std::max(0.0f, 1.0f - distances[i] * (1.0f / kGate));
  double support = 0;
  for (const float r : regions) support += std::sqrt(r);
  return support;
}

double support_of(const MotionSamples& s, const Transform& t) {
  Distances distances;
  measure(s, t, distances);
  return support_of(s, distances);
}

// The similarity that takes sample i's and j's points of frame k-1 to those of frame k; false if it is no camera motion.
bool similarity_through(const MotionSamples& s, int i, int j, double least_distance, Transform& t) {
  const double px = s.x[j] - s.x[i], py = s.y[j] - s.y[i], qx = s.u[j] - s.u[i], qy = s.v[j] - s.v[i];
  const double square = px * px + py * py;
  if (square < least_distance * least_distance) return false;
  const double a = (px * qx + py * qy) / square, b = (px * qy - py * qx) / square;
  if (a < 0.6 || a > 1.6 || std::abs(b) > 0.5) return false;
  t = {{a, -b, s.u[i] - a * s.x[i] + b * s.y[i], b, a, s.v[i] - b * s.x[i] - a * s.y[i], 0, 0, 1}};
  return true;
}

// Normal equations of at most 8 unknowns.
struct Normal {
  std::array<std::array<double, 8>, 8> a{};
  std::array<double, 8> b{};
  int n = 0;

  // Adds the measurement J p = d (two rows) with the 2x2 weight W.
  void add(const std::array<double, 8>& jx, const std::array<double, 8>& jy, double dx, double dy, double wxx,
           double wxy, double wyy) {
    for (int i = 0; i < n; ++i) {
      const double ex = jx[i] * wxx + jy[i] * wxy, ey = jx[i] * wxy + jy[i] * wyy;
      for (int j = i; j < n; ++j) a[i][j] += ex * jx[j] + ey * jy[j];
      b[i] += ex * dx + ey * dy;
    }
  }

  // Cholesky. False when not positive definite.
  bool solve(std::array<double, 8>& p) {
    for (int i = 0; i < n; ++i)
      for (int j = i; j < n; ++j) {
        double sum = a[i][j];
        for (int k = 0; k < i; ++k) sum -= a[k][i] * a[k][j];
        if (i == j) {
          if (!(sum > 1e-12)) return false;
          a[i][i] = std::sqrt(sum);
        } else {
          a[i][j] = sum / a[i][i];
        }
      }
    for (int i = 0; i < n; ++i) {
      double sum = b[i];
      for (int k = 0; k < i; ++k) sum -= a[k][i] * p[k];
      p[i] = sum / a[i][i];
    }
    for (int i = n - 1; i >= 0; --i) {
      double sum = p[i];
      for (int k = i + 1; k < n; ++k) sum -= a[i][k] * p[k];
      p[i] = sum / a[i][i];
    }
    return true;
  }
};

int unknowns(MotionModel model) {
  switch (model) {
    case MotionModel::none:
      return 0;
    case MotionModel::translation:
      return 2;
    case MotionModel::similarity:
      return 4;
    case MotionModel::affine:
      return 6;
    case MotionModel::homography:
      return 8;
  }
  return 0;
}

// One weighted least squares step. Unknowns are displacements in pixels at the picture's edge, so that one weak prior
// fits all of them: X, Y are pixels from the centre over the half diagonal `scale`.
//   X' = X + (t + a X + b Y - (g X + h Y) X') / scale
class LeastSquares {
 public:
  LeastSquares(MotionModel model, Size picture)
      : model_(model),
        cx_(0.5 * (picture.width - 1)),
        cy_(0.5 * (picture.height - 1)),
        scale_(0.5 * std::hypot(picture.width, picture.height)) {}

  bool step(const MotionSamples& s, const std::array<float, MotionSamples::kMax>& weights,
            Transform& t) const {
    Normal normal;
    normal.n = unknowns(model_);
    // Priors (pixels): shift free, linear part 10 % of the scale, perspective 3 %.
    for (int i = 0; i < normal.n; ++i) {
      const double sigma = (i < 2 ? 10.0 : i < 6 ? 0.1 : 0.03) * scale_;
      normal.a[i][i] = 1 / (sigma * sigma);
    }
    std::array<double, 8> jx{}, jy{};
    for (int i = 0; i < s.count; ++i) {
      const double w = weights[i];
      if (!(w > 0)) continue;
      const double X = (s.x[i] - cx_) / scale_, Y = (s.y[i] - cy_) / scale_;
      const double U = (s.u[i] - cx_) / scale_, V = (s.v[i] - cy_) / scale_;
      if (model_ == MotionModel::similarity) {
        jx = {1, 0, X, -Y}, jy = {0, 1, Y, X};
      } else {
        jx = {1, 0, X, Y, 0, 0, -X * U, -Y * U}, jy = {0, 1, 0, 0, X, Y, -X * V, -Y * V};
      }
      normal.add(jx, jy, s.u[i] - s.x[i], s.v[i] - s.y[i], w * s.wxx[i], w * s.wxy[i], w * s.wyy[i]);
    }
    std::array<double, 8> p{};
    if (!normal.solve(p)) return false;
    for (double& v : p) v /= scale_;
    const Transform centred = model_ == MotionModel::similarity
                                  ? Transform{{1 + p[2], -p[3], p[0], p[3], 1 + p[2], p[1], 0, 0, 1}}
                                  : Transform{{1 + p[2], p[3], p[0], p[4], 1 + p[5], p[1], p[6], p[7], 1}};
    const Transform to{{1 / scale_, 0, -cx_ / scale_, 0, 1 / scale_, -cy_ / scale_, 0, 0, 1}};
    const Transform from{{scale_, 0, cx_, 0, scale_, cy_, 0, 0, 1}};
    t = from * centred * to;
    return true;
  }

 private:
  MotionModel model_;
  double cx_, cy_, scale_;
};

// The few best hypotheses that mean different motions.
class Contenders {
 public:
  explicit Contenders(Size picture) : picture_(picture), alike_(0.02 * picture.width) {}

  void add(const Transform& t, double support) {
    if (count_ == kMost && support <= entries_[kMost - 1].support) return;
    int place = 0;  // of the entry it takes over: its like, or the weakest
    while (place < count_ && !alike(entries_[place].transform, t)) ++place;
    if (place < count_ && support <= entries_[place].support) return;
    if (place == count_) place = count_ < kMost ? count_++ : kMost - 1;
    for (; place > 0 && entries_[place - 1].support < support; --place) entries_[place] = entries_[place - 1];
    entries_[place] = {t, support};
  }
  Transform best() const { return entries_[0].transform; }
  std::span<const Transform> all() {
    for (int i = 0; i < count_; ++i) transforms_[i] = entries_[i].transform;
    return {transforms_.data(), static_cast<std::size_t>(count_)};
  }

 private:
  static constexpr int kMost = 3;
  struct Entry {
    Transform transform;
    double support = 0;
  };

  bool alike(const Transform& a, const Transform& b) const {
    const double right = picture_.width - 1, low = picture_.height - 1;
    for (const Point p : {Point{0, 0}, Point{right, low}, Point{0.5 * right, 0.5 * low}}) {
      const Point q = a.apply(p), r = b.apply(p);
      if (std::abs(q.x - r.x) + std::abs(q.y - r.y) > alike_) return false;
    }
    return true;
  }

  Size picture_;
  double alike_;
  int count_ = 0;
  std::array<Entry, kMost> entries_;
  std::array<Transform, kMost> transforms_;
};

}  // namespace

bool follows(const MotionSamples& s, int i, const Transform& transform) {
  const Point p = transform.apply({s.x[i], s.y[i]});
  const double dx = s.u[i] - p.x, dy = s.v[i] - p.y;
  return s.wxx[i] * dx * dx + 2 * s.wxy[i] * dx * dy + s.wyy[i] * dy * dy <= kGate;
}

MotionFit rate_motion(const MotionSamples& s, const Transform& transform) {
  Distances distances;
  measure(s, transform, distances);
  MotionFit fit;
  fit.transform = transform;
  fit.support = support_of(s, distances);
  double squares = 0;
  for (int i = 0; i < s.count; ++i) {
    fit.cost += s.evidence[i] * std::min(distances[i], kGate);
    if (distances[i] > kGate) continue;
    const Point p = transform.apply({s.x[i], s.y[i]});
    const double dx = s.u[i] - p.x, dy = s.v[i] - p.y;
    squares += s.evidence[i] * (dx * dx + dy * dy);
    fit.agreeing += s.evidence[i];
  }
  fit.residual = fit.agreeing > 0 ? std::sqrt(squares / fit.agreeing) : 0;
  return fit;
}

MotionFit refine_motion(const MotionSamples& s, MotionModel model, Size picture, const Transform& start) {
  const LeastSquares squares(model, picture);
  Transform t = start;
  Distances distances, weights{};
  if (model == MotionModel::none) return rate_motion(s, t);
  for (const float gates : kGates) {
    measure(s, t, distances);
    for (int i = 0; i < s.count; ++i) {
      const float inside = std::max(0.0f, 1.0f - distances[i] / (gates * kGate));
      weights[i] = inside * inside;  // Tukey's biweight
    }
    Transform next;
    if (!squares.step(s, weights, next) || !next.is_sane(picture)) break;
    t = next;
  }
  return rate_motion(s, t);
}

MotionFit fit_motion(const MotionSamples& s, MotionModel model, Size picture,
                     std::span<const Transform> guesses, int hypotheses) {
  Contenders contenders(picture);
  for (const Transform& t : guesses) contenders.add(t, support_of(s, t));
  if (model == MotionModel::none || s.count == 0) return rate_motion(s, contenders.best());
  const double least_distance = 0.15 * picture.width;
  std::uint32_t random = 12345;  // linear congruence (Numerical Recipes), its upper bits
  const auto draw = [&] {
    random = random * 1664525u + 1013904223u;
    return static_cast<int>((std::uint64_t{random} * static_cast<std::uint32_t>(s.count)) >> 32);
  };
  for (int h = 0; h < hypotheses; ++h) {
    const int i = draw(), j = draw();
    Transform t = Transform::translation(s.u[i] - s.x[i], s.v[i] - s.y[i]);
    const bool shift = model == MotionModel::translation || h % 4 == 0;
    if (shift || similarity_through(s, i, j, least_distance, t)) contenders.add(t, support_of(s, t));
  }
  // A hypothesis from two samples carries their errors; only refined ones can be compared.
  const MotionModel simple = std::min(model, MotionModel::similarity);
  MotionFit fit;
  fit.support = -1;
  for (const Transform& t : contenders.all())
    if (const MotionFit refined = refine_motion(s, simple, picture, t); refined.support > fit.support)
      fit = refined;
  if (model > simple) {
    const MotionFit finer = refine_motion(s, model, picture, fit.transform);
    if (finer.support >= fit.support) fit = finer;
  }
  return fit;
}

}  // namespace cerberus::vision
