// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/camera_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vision/global_shift.h"
#include "vision/patches.h"
#include "vision/pyramid.h"

namespace cerberus::vision {

namespace {

constexpr int kLeastSide = 16;        // smaller pictures are not estimated
constexpr float kFound = 0.7f;        // correlation of a patch that was found again
constexpr double kStillMotion = 0.1;  // motion of the picture's corners that may be taken for none, pixels
constexpr double kPlacement = 0.06;   // what a good match is off even without noise, pixels

int search_level(Size size) {
  int level = 0;
  while (std::max(size.width, size.height) >> level > Relief::kMaxSide) ++level;
  return level;
}

}  // namespace

struct CameraMotion::State {
  CameraMotionOptions options;
  Pyramid reference, current;  // the reference is frame k-1, or an earlier one while the camera stands
  Relief reference_relief, current_relief;
  PatchSites sites;
  bool sites_stale = true;
  Image<std::int32_t> scratch;
  std::array<PatchMatch, MotionSamples::kMax> matches;
  MotionSamples samples;
  Transform last;  // frame k-2 to k-1
  double noise = 1;
  bool still = false;
  int scene_age = 0;

  CameraMotionResult start_scene();
  CameraMotionResult estimate(const std::optional<Transform>& prior);
  Transform first_guess(int level, const std::optional<Transform>& prior, double& rating);
  void follow(int level, const Transform& guess, int rounds);
  void collect(int level);
  bool is_still(const MotionFit& fit) const;
};

CameraMotion::CameraMotion() : state_(std::make_unique<State>()) {}
CameraMotion::~CameraMotion() = default;
CameraMotion::CameraMotion(CameraMotion&&) noexcept = default;
CameraMotion& CameraMotion::operator=(CameraMotion&&) noexcept = default;

void CameraMotion::set_options(const CameraMotionOptions& options) {
  state_->options = options;
}

void CameraMotion::reset() {
  state_->scene_age = 0;
}

std::size_t CameraMotion::bytes() const {
  return sizeof(State) + state_->reference.bytes() + state_->current.bytes() + state_->scratch.bytes();
}

CameraMotionResult CameraMotion::State::start_scene() {
  reference.swap(current);
  std::swap(reference_relief, current_relief);
  sites_stale = true;
  still = false;
  last = {};
  scene_age = 1;
  CameraMotionResult result;
  result.scene_age = 1;
  return result;
}

// Follows every patch on one level, first looked for where `guess` (level 0 pixels) says.
void CameraMotion::State::follow(int level, const Transform& guess, int rounds) {
  const GrayView from = reference.level(level), to = current.level(level);
  const Transform scaled =
      guess.rescaled(reference.size(), {1, 1}).rescaled({1 << level, 1 << level}, {1, 1});
  (void)scaled;
  const double s = 1 << level;
  for (int i = 0; i < sites.count; ++i) {
    const PatchSite& site = sites.site[i];
    const Point p = guess.apply({site.x, site.y});
    matches[i] = follow_patch(from, to, level, site, static_cast<float>((p.x - site.x) / s),
                              static_cast<float>((p.y - site.y) / s), rounds);
  }
}

// Turns the matches of one level into samples in level 0 pixels.
void CameraMotion::State::collect(int level) {
  const float scale = static_cast<float>(1 << level), shift = 0.5f * (scale - 1);
  samples.count = 0;
  for (int i = 0; i < sites.count; ++i) {
    const PatchMatch& m = matches[i];
    if (m.correlation < kFound) continue;
    const int n = samples.count++;
    samples.x[n] = m.x * scale + shift, samples.y[n] = m.y * scale + shift;
    samples.u[n] = (m.x + m.dx) * scale + shift, samples.v[n] = (m.y + m.dy) * scale + shift;
    samples.region[n] = sites.site[i].region;
    // Covariance of the match: noise over gradient information, plus placement, plus what a simple model of the
    // picture's motion cannot follow (it grows with the motion).
    const double noise2 = std::max<double>(m.noise2, 0.5);
    const double dx = samples.u[n] - samples.x[n], dy = samples.v[n] - samples.y[n];
    const double floor = scale * scale * kPlacement * kPlacement + 0.02 * 0.02 * (dx * dx + dy * dy);
    const double ridge = 0.01 * (m.hxx + m.hyy) + 1;
    const double a = m.hxx + ridge, b = m.hxy, c = m.hyy + ridge;
    const double k = noise2 * scale * scale / (a * c - b * b);
    const double vxx = c * k + floor, vxy = -b * k, vyy = a * k + floor;
    const double det = vxx * vyy - vxy * vxy;
    samples.wxx[n] = static_cast<float>(vyy / det);
    samples.wxy[n] = static_cast<float>(-vxy / det);
    samples.wyy[n] = static_cast<float>(vxx / det);
    const double large = 0.5 * (vxx + vyy) + std::hypot(0.5 * (vxx - vyy), vxy);
    samples.evidence[n] = static_cast<float>(1 / (1 + large / (0.25 * scale * scale)));
  }
}

// The most promising of: standing still, the last motion, the head's pose, the coarse search.
Transform CameraMotion::State::first_guess(int level, const std::optional<Transform>& prior, double& rating) {
  const double coarse = 1 << search_level(reference.size());
  const std::array<Shift, 2> shifts = ShiftSearch{}.run(reference_relief, current_relief);
  std::array<Transform, 5> guesses{Transform{}, last,
                                   Transform::translation(shifts[0].dx * coarse, shifts[0].dy * coarse),
                                   Transform::translation(shifts[1].dx * coarse, shifts[1].dy * coarse)};
  int count = 4;
  if (prior && prior->is_sane(reference.size())) guesses[count++] = *prior;
  rating = -1;
  Transform best;
  for (int g = 0; g < count; ++g) {
    if (g == 1 && last.is_identity()) continue;
    follow(level, guesses[g], 0);
    double sum = 0;
    for (int i = 0; i < sites.count; ++i) sum += std::max(0.0f, matches[i].correlation - 0.3f);
    if (g == 0) sum *= 1.05;
    if (sum > rating) rating = sum, best = guesses[g];
  }
  return best;
}

bool CameraMotion::State::is_still(const MotionFit& fit) const {
  if (fit.transform.corner_motion(reference.size()) < kStillMotion) return true;
  const MotionFit none = rate_motion(samples, {});
  if (none.support > (still ? 0.75 : 0.9) * fit.support && none.cost < fit.cost + 12) return true;
  return false;
}

CameraMotionResult CameraMotion::State::estimate(const std::optional<Transform>& prior) {
  const Size size = reference.size();
  if (sites_stale) sites.choose(reference, noise, scratch);
  sites_stale = false;
  const int top = std::max(0, search_level(size) - 1);
  CameraMotionResult result;
  result.scene_age = ++scene_age;
  double rating;
  Transform motion = first_guess(top, prior, rating);
  MotionFit fit;
  for (int level = top; level >= 0; --level) {
    follow(level, motion, level == top ? 6 : 3);
    collect(level);
    const std::array guesses{Transform{}, motion};
    const MotionModel model =
        level > 0 && options.model > MotionModel::similarity ? MotionModel::similarity : options.model;
    fit = fit_motion(samples, model, size, guesses);
    motion = fit.transform;
  }
  double evidence = 0;
  for (int i = 0; i < samples.count; ++i) evidence += samples.evidence[i];
  // A cut: hardly anything of the earlier picture is found again, wherever it is looked for.
  const double found = sites.count ? static_cast<double>(samples.count) / sites.count : 1;
  const double share = evidence > 0 ? fit.agreeing / evidence : 0;
  if (sites.count >= 8 && found * share < 0.25) return start_scene();
  if (options.model == MotionModel::none || is_still(fit)) {
    fit = rate_motion(samples, {});
    still = true;
  } else {
    still = false;
  }
  result.transform = fit.transform;
  result.confidence = sites.count ? fit.agreeing / std::max(evidence, 1e-6) * std::min(1.0, found * 1.25) : 0;
  result.residual = fit.residual;
  result.still = still;
  last = fit.transform;
  reference.swap(current);
  std::swap(reference_relief, current_relief);
  sites_stale = true;
  return result;
}

CameraMotionResult CameraMotion::update(GrayView picture, const std::optional<Transform>& prior) {
  State& s = *state_;
  if (picture.empty()) return {};
  if (s.reference.size() != picture.size()) s.scene_age = 0;
  const int level = search_level(picture.size());
  s.current.build(picture, level + 1);
  s.current_relief.build(s.current.level(std::min(level, s.current.levels() - 1)));
  if (s.scene_age == 0) return s.start_scene();
  if (std::min(picture.width, picture.height) < kLeastSide) {
    const int age = s.scene_age + 1;
    CameraMotionResult result = s.start_scene();
    result.scene_age = s.scene_age = age;
    result.still = true;
    return result;
  }
  return s.estimate(prior);
}

}  // namespace cerberus::vision
