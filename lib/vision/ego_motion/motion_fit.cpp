// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/motion_fit.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "vision/ego_motion/motion_fit_kernels.h"
#include "vision/ego_motion/motion_least_squares.h"

namespace cerberus::vision {

namespace {

// Where no origin stands it is unknown: kept from the first version. Guard of all: bench-camera_motion, bench-steady and
// tests/unit/motion_fit.
constexpr struct Parameters {
  // Widths of Tukey's weights in the rounds of refinement, in gates: wide first, because the start is a guess, and wider
  // for a model that starts from a similarity.
  std::array<float, 5> gates{6.0f, 3.0f, 1.5f, 1.5f, 1.5f}, richer_gates{50.0f, 12.0f, 3.0f, 1.5f, 1.5f};
  // Weight of the six parts in the middle for MotionFit::ground. A near person fills the middle and reaches the lower
  // edge, and the background surrounds the person (the prior of Wei, Wen, Zhu, Sun, Geodesic saliency using background
  // priors, ECCV 2012).
  double inside = 0.25;

  // Hypotheses.
  double least_zoom = 0.6, most_zoom = 1.6;  // from frame to frame: a camera motion
  double most_roll = 0.5;                    // sine of the angle times the zoom: the same
  double least_distance = 0.15;              // of the width: between the samples of a similarity
  int shifts = 4;                            // every so manieth hypothesis is a shift
  double enough =
      0.85;  // of the possible support: no more hypotheses. derived: inlier noise costs the last tenth
  double hopeless = 0.4;  // of the best one's support: a weaker hypothesis is not refined
  // Bends of lenses of 50, 65, 80 and 100 degrees.
  std::array<double, 4> lenses{0.3, 0.6, 1.2, 2.4};

  // F tests on the truncated cost that decide whether the richer model explains more than chance does with its
  // additional unknowns. derived: F(1), F(2), F(2), F(4) of many samples at a level of about one in a thousand, times
  // the unknowns. A model that fails would only follow noise in the corners of the picture.
  double bend_earns = 10.8, rolling_earns = 2 * 6.9, affine_earns = 2 * 6.9, homography_earns = 4 * 4.6;
  double least_unexplained = 0.2;  // of the noise, per direction: the tests' denominator
  double as_supported = 0.95;      // of the simpler model's support that the richer one needs

  // Memory of the lens.
  double remembered = 0.97;  // share that is kept from frame to frame
} kParameters;

double support_of(const Agreement& agreement) {
  double support = 0;
  for (const float part : agreement.of_region) support += std::sqrt(part);
  return support;
}

// Returns the support that a motion would have with all samples within the gate.
double greatest_support(const MotionSamples& s) {
  Agreement agreement;
  for (int i = 0; i < s.count; ++i) agreement.of_region[s.region[i]] += s.evidence[i];
  return support_of(agreement);
}

// Weights of the parts of the picture for MotionFit::ground.
constexpr double kInside = kParameters.inside;
constexpr std::array<double, MotionSamples::kRegions> kGround{1, 1,       1,       1,  //
                                                              1, kInside, kInside, 1,  //
                                                              1, kInside, kInside, 1,  //
                                                              1, kInside, kInside, 1};

// Returns whether two motions are equivalent: most followers of the one with fewer followers also follow the other.
bool alike(const Followers& a, const Followers& b) {
  return 2 * a.common(b) > std::min(a.count(), b.count());
}

// Computes the similarity that maps the points of samples i and j in frame k-1 to those in frame k; returns false if it
// is impossible as a camera motion.
bool similarity_through(const MotionSamples& s, int i, int j, double least_distance, Transform& t) {
  const double px = s.x[j] - s.x[i], py = s.y[j] - s.y[i], qx = s.u[j] - s.u[i], qy = s.v[j] - s.v[i];
  const double square = px * px + py * py;
  if (square < least_distance * least_distance) return false;
  const double a = (px * qx + py * qy) / square, b = (px * qy - py * qx) / square;
  if (a < kParameters.least_zoom || a > kParameters.most_zoom || std::abs(b) > kParameters.most_roll)
    return false;
  t = {{a, -b, s.u[i] - a * s.x[i] + b * s.y[i], b, a, s.v[i] - b * s.x[i] - a * s.y[i], 0, 0, 1}};
  return true;
}

// The few best hypotheses that are different motions.
class Contenders {
 public:
  struct Entry {
    Transform transform;
    double support = 0;
    Followers followers;
  };

  explicit Contenders(const SampleRows& rows) : rows_(rows) {}

  void add(const Transform& t) {
    const Agreement agreement = agreement_with(rows_, t);
    const double support = support_of(agreement);
    if (count_ == kMost && support <= entries_[kMost - 1].support) return;
    const Followers& followers = agreement.followers;
    int place = 0;  // index of the entry that is replaced: the equivalent one, or the weakest
    while (place < count_ && !alike(entries_[place].followers, followers)) ++place;
    if (place < count_ && support <= entries_[place].support) return;
    if (place == count_) place = count_ < kMost ? count_++ : kMost - 1;
    for (; place > 0 && entries_[place - 1].support < support; --place) entries_[place] = entries_[place - 1];
    entries_[place] = {t, support, followers};
  }
  Transform best() const { return entries_[0].transform; }
  double most() const { return entries_[0].support; }
  std::span<const Entry> all() const { return {entries_.data(), static_cast<std::size_t>(count_)}; }

 private:
  static constexpr int kMost = 5;

  const SampleRows& rows_;
  int count_ = 0;
  std::array<Entry, kMost> entries_;
};

// Least squares with Tukey's biweight, a round for each width. step(normal, next) solves.
template <typename Step>
void reweight(const SampleRows& rows, std::span<const float> gates, const MotionScale& scale, Size picture,
              bool perspective, Transform& motion, Step&& step) {
  for (const float gate : gates) {
    Transform next = motion;
    if (!step(sum_normal(rows, motion, gate * kGate, scale, perspective), next) || !next.is_sane(picture))
      break;
    motion = next;
  }
}

struct Rated : MotionFit {
  Followers followers;
};

Rated rate(const SampleRows& rows, const Transform& transform) {
  const Agreement agreement = agreement_with(rows, transform);
  Rated fit;
  fit.transform = transform;
  for (int r = 0; r < MotionSamples::kRegions; ++r) {
    const double part = std::sqrt(agreement.of_region[r]);
    fit.support += part, fit.ground += kGround[r] * part;
  }
  fit.cost = agreement.cost, fit.agreeing = agreement.agreeing;
  fit.residual = fit.agreeing > 0 ? std::sqrt(agreement.squares / fit.agreeing) : 0;
  fit.followers = agreement.followers;
  return fit;
}

Rated refined(const SampleRows& rows, MotionModel model, Size picture, Transform motion) {
  const MotionLeastSquares squares(picture);
  reweight(rows, model > MotionModel::similarity ? kParameters.richer_gates : kParameters.gates,
           squares.scale(), picture, model == MotionModel::homography, motion,
           [&](const MotionNormal& normal, Transform& next) { return squares.step(model, normal, next); });
  return rate(rows, motion);
}

// Fits a turn: the similarity with the bend of a turning camera's picture, which depends on the lens alone. `motion` is
// the initial value.
Rated turned(const SampleRows& rows, Size picture, Shutter shutter, const LensBend& known, Transform motion) {
  const MotionLeastSquares squares(picture);
  LensBend seen;
  reweight(rows, std::span(kParameters.gates).subspan(1), squares.scale(), picture, true, motion,
           [&](const MotionNormal& normal, Transform& next) {
             LensBend lens = known;
             if (!squares.step_turned(normal, shutter, lens, next) || !next.is_sane(picture)) return false;
             seen = lens;
             return true;
           });
  Rated fit = rate(rows, motion);
  fit.lens = seen;
  return fit;
}

// Returns a turn without its bend, which is zero in the middle of the picture.
Transform unbent(const Transform& turn, Size picture) {
  const double x = 0.5 * (picture.width - 1), y = 0.5 * (picture.height - 1);
  Transform centred = Transform::translation(-x, -y) * turn * Transform::translation(x, y);
  for (double& m : centred.m) m /= centred.m[8];
  centred.m[6] = centred.m[7] = 0;
  return Transform::translation(x, y) * centred * Transform::translation(-x, -y);
}

// Returns the cost that inliers leave unexplained, for each direction.
double unexplained(const MotionFit& fit) {
  return std::max(fit.agreeing > 1 ? fit.cost / (2 * fit.agreeing) : 1, kParameters.least_unexplained);
}
double earned(const MotionFit& finer, const MotionFit& fit) {
  return (fit.cost - finer.cost) / unexplained(finer);
}
bool is_as_supported(const MotionFit& finer, const MotionFit& fit) {
  return finer.support > kParameters.as_supported * fit.support;
}

}  // namespace

bool follows(const MotionSamples& s, int i, const Transform& transform) {
  const Point p = transform.apply({s.x[i], s.y[i]});
  const double dx = s.u[i] - p.x, dy = s.v[i] - p.y;
  return s.wxx[i] * dx * dx + 2 * s.wxy[i] * dx * dy + s.wyy[i] * dy * dy <= kGate;
}

MotionFit rate_motion(const MotionSamples& s, const Transform& transform) {
  return rate(SampleRows(s), transform);
}

double refine_motion(const MotionSamples& s, MotionModel model, Size picture, Transform& motion) {
  const MotionFit fit = refined(SampleRows(s), model, picture, motion);
  motion = fit.transform;
  return fit.support;
}

MotionFit fit_motion(const MotionSamples& s, MotionModel model, Size picture,
                     std::span<const Transform> guesses, int hypotheses, int turns, const LensBend& known) {
  const Parameters& q = kParameters;
  const SampleRows rows(s);
  Contenders contenders(rows);
  for (const Transform& t : guesses) contenders.add(t);
  if (model == MotionModel::none || s.count == 0) return rate(rows, contenders.best());
  const double least_distance = q.least_distance * picture.width;
  std::uint32_t random = 12345;  // linear congruence (Numerical Recipes), its upper bits
  const auto draw = [&] {
    random = random * 1664525u + 1013904223u;
    return static_cast<int>((std::uint64_t{random} * static_cast<std::uint32_t>(s.count)) >> 32);
  };
  const double enough = q.enough * greatest_support(s);
  for (int h = 0; h < hypotheses && contenders.most() < enough; ++h) {
    const int i = draw(), j = draw();
    Transform t = Transform::translation(s.u[i] - s.x[i], s.v[i] - s.y[i]);
    const bool shift = model == MotionModel::translation || h % q.shifts == 0;
    if (shift || similarity_through(s, i, j, least_distance, t)) contenders.add(t);
  }
  // The bend of a wide lens is too far from any similarity to be reached by refinement: add turns from one sample each,
  // through the known lens or through usual ones.
  const bool may_bend = model == MotionModel::similarity || model == MotionModel::homography;
  const MotionLeastSquares squares(picture);
  for (int h = 0; h < turns && may_bend && contenders.most() < enough; ++h) {
    const int i = draw();
    const double bend = known.earned > q.bend_earns ? known.bend : q.lenses[h % q.lenses.size()];
    const Transform t = squares.turn({s.x[i], s.y[i]}, {s.u[i], s.v[i]}, bend);
    if (t.is_sane(picture)) contenders.add(t);
  }
  // A hypothesis from two samples has their errors; hypotheses are refined before they are compared.
  const MotionModel simple = std::min(model, MotionModel::similarity);
  Rated fit, rival;
  bool first = true;
  for (const auto& [hypothesis, support, unrefined] : contenders.all()) {
    if (support < q.hopeless * contenders.most()) break;
    const Rated better = may_bend && !hypothesis.is_affine()
                             ? turned(rows, picture, Shutter::global, known, hypothesis)
                             : refined(rows, simple, picture, hypothesis);
    if (first) {
      fit = better, first = false;
    } else if (alike(better.followers, fit.followers)) {
      if (better.support > fit.support) fit = better;
    } else if (better.ground > fit.ground) {
      rival = fit, fit = better;
    } else if (better.ground > rival.ground) {
      rival = better;
    }
  }
  if (rival.ground > 0) fit.rival = rival.transform;
  if (model <= MotionModel::similarity) return fit;
  MotionFit finer = refined(rows, model, picture, fit.transform);
  finer.rival = fit.rival;
  const double earns = model == MotionModel::affine ? q.affine_earns : q.homography_earns;
  return is_as_supported(finer, fit) && earned(finer, fit) > earns ? finer : fit;
}

MotionFit fit_turn(const MotionSamples& s, Size picture, const MotionFit& found, const LensBend& known) {
  const SampleRows rows(s);
  MotionFit similarity = found, bent = found;
  if (found.transform.is_affine()) {
    bent = turned(rows, picture, Shutter::global, known, found.transform);
  } else {
    similarity = refined(rows, MotionModel::similarity, picture, unbent(found.transform, picture));
  }
  bent.lens.earned = earned(bent, similarity);
  const bool bends =
      is_as_supported(bent, similarity) && known.earned + bent.lens.earned > kParameters.bend_earns;
  MotionFit fit = bends ? bent : similarity;
  // The sheared motion is also bent: it must pass the F test for both.
  const MotionFit rolled = turned(rows, picture, Shutter::rolling, known, bent.transform);
  const double earns = kParameters.rolling_earns + (bends ? 0 : kParameters.bend_earns);
  if (is_as_supported(rolled, fit) && earned(rolled, fit) > earns) fit = rolled;
  fit.lens = bent.lens;
  return fit;
}

void LensBend::learn(const LensBend& seen) {
  const Parameters& q = kParameters;
  constexpr double kContradicts = kGate;
  information *= q.remembered;
  earned = std::max(q.remembered * earned + seen.earned, 0.0);
  if (!(seen.information > 0)) return;
  const double apart = seen.bend - bend;
  if (information > 0 && apart * apart > kContradicts * (1 / information + 1 / seen.information))
    information = 0, earned = std::max(seen.earned, 0.0);
  bend += (seen.bend - bend) * seen.information / (information + seen.information);
  information += seen.information;
}

}  // namespace cerberus::vision
