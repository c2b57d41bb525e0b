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

constexpr int kLeastSide = 16;  // smaller pictures are not estimated
constexpr float kFound = 0.7f;  // correlation of a patch that was found again
constexpr float kFoundWell = 0.95f;
constexpr int kLeastPatches = 8;      // fewer say nothing about a cut
constexpr int kReferenceAge = 16;     // frames after which a standing camera's reference is renewed
constexpr double kMajority = 0.6;     // share of the patches that no other motion can outvote
constexpr double kBent = 0.2;         // pixels: less is nothing
constexpr double kStillMotion = 0.2;  // pixels, RMS over the picture: a camera that stood still does

int search_level(Size size) {
  int level = 0;
  while (std::max(size.width, size.height) >> level > Relief::kMaxSide) ++level;
  return level;
}

// RMS motion over a grid of the picture: what a shift of that many pixels would give.
double mean_motion(const Transform& t, Size size) {
  constexpr int kGrid = 4;
  double squares = 0;
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i < kGrid; ++i) {
      const Point p{(i + 0.5) * size.width / kGrid, (j + 0.5) * size.height / kGrid}, q = t.apply(p);
      squares += (q.x - p.x) * (q.x - p.x) + (q.y - p.y) * (q.y - p.y);
    }
  return std::sqrt(squares / (kGrid * kGrid));
}

// By how many pixels, at most, a homography bends the picture: what a simpler model cannot follow.
double bend(const Transform& t, Size size) {
  return 0.25 * (std::abs(t.m[6]) * size.width + std::abs(t.m[7]) * size.height) *
         std::max(size.width, size.height);
}

}  // namespace

// The reference is frame k-1 while the camera moves. While it stands, the reference stays for a while: a motion too
// slow to be seen from frame to frame adds up until it is seen, instead of being snapped away for ever.
struct CameraMotion::State {
  CameraMotionOptions options;
  Pyramid reference, current;
  Relief reference_relief, current_relief;
  PatchSites sites;  // in the reference
  bool sites_chosen = false;
  int reference_age = 0;  // frames since the reference
  Image<std::int32_t> scratch;
  std::array<PatchMatch, MotionSamples::kMax> matches;
  MotionSamples samples;
  MotionSamples beyond;                                 // see fit_beyond()
  std::array<float, MotionSamples::kMax> correlations;  // of the samples
  double share = 0, share_well = 0;  // see count_followers(); on the level where they are highest
  int looked_for = 0;                // patches whose place lies in the current picture
  Transform last;                    // frame k-2 to k-1
  double noise = 1;                  // standard deviation of a pixel
  bool still = false;
  int scene_age = 0;

  std::optional<CameraMotionResult> confirm_still();
  CameraMotionResult estimate(const std::optional<Transform>& prior);
  CameraMotionResult start_scene();
  PatchMatch look(const PatchFollower& patch, int level, const PatchSite& site, const Transform& guess,
                  int rounds) const;
  Transform follow_from_guesses(int level, const std::array<Shift, 2>& shifts,
                                const std::optional<Transform>& prior);
  void follow(int level, const Transform& guess);
  void collect(int level);
  MotionFit fit_beyond(const Transform& prior, MotionModel model, const Transform& guess, int hypotheses);
  void count_followers(const MotionFit& fit);
  bool is_cut(const Shift& shift) const;
  bool is_still(const MotionFit& fit) const;
  bool is_known(const MotionFit& fit) const;
  void measure_noise();
  void next_reference(bool keep);
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

void CameraMotion::State::next_reference(bool keep) {
  if (keep && ++reference_age < kReferenceAge) return;
  reference.swap(current);
  std::swap(reference_relief, current_relief);
  sites_chosen = false;
  reference_age = 0;
}

CameraMotionResult CameraMotion::State::start_scene() {
  next_reference(false);
  still = false;
  last = {};
  scene_age = 1;
  CameraMotionResult result;
  result.scene_age = 1;
  return result;
}

// Looks for one patch where `guess` (level 0 pixels) says it went.
PatchMatch CameraMotion::State::look(const PatchFollower& patch, int level, const PatchSite& site,
                                     const Transform& guess, int rounds) const {
  const float scale = 1.0f / static_cast<float>(1 << level);
  const Point p = guess.apply({site.x, site.y});
  return patch.follow(current.level(level), static_cast<float>(p.x - site.x) * scale,
                      static_cast<float>(p.y - site.y) * scale, rounds);
}

// Follows every patch on one level, first looked for where `guess` says.
void CameraMotion::State::follow(int level, const Transform& guess) {
  looked_for = 0;
  for (int i = 0; i < sites.count; ++i) {
    const PatchSite& site = sites.site[i];
    matches[i] = look(PatchFollower(reference.level(level), level, site), level, site, guess, 3);
    looked_for += matches[i].inside;
  }
}

// Turns the matches of one level into samples in level 0 pixels.
void CameraMotion::State::collect(int level) {
  const float scale = static_cast<float>(1 << level), shift = 0.5f * (scale - 1);
  // What a good match is off even without noise: a sixteenth of a pixel of a picture 320 wide.
  const float placement = 0.06f * scale * std::max(1.0f, static_cast<float>(reference.size().width) / 320);
  samples.count = 0;
  for (int i = 0; i < sites.count; ++i) {
    const PatchMatch& m = matches[i];
    if (m.correlation < kFound) continue;
    const int n = samples.count++;
    samples.x[n] = m.x * scale + shift, samples.y[n] = m.y * scale + shift;
    samples.u[n] = (m.x + m.dx) * scale + shift, samples.v[n] = (m.y + m.dy) * scale + shift;
    correlations[n] = m.correlation;
    samples.region[n] = sites.site[i].region;
    // Covariance of the match: noise over gradient information, plus placement, plus what a simple model of the
    // picture's motion cannot follow (it grows with the motion).
    const float dx = samples.u[n] - samples.x[n], dy = samples.v[n] - samples.y[n];
    const float floor = placement * placement + 0.02f * 0.02f * (dx * dx + dy * dy);
    const float ridge = 0.01f * (m.hxx + m.hyy) + 1;
    const float a = m.hxx + ridge, b = m.hxy, c = m.hyy + ridge;
    const float k = std::max(m.noise2, 0.5f) * scale * scale / (a * c - b * b);
    const float vxx = c * k + floor, vxy = -b * k, vyy = a * k + floor;
    const float per_determinant = 1 / (vxx * vyy - vxy * vxy);
    samples.wxx[n] = vyy * per_determinant;
    samples.wxy[n] = -vxy * per_determinant;
    samples.wyy[n] = vxx * per_determinant;
    const float spread = std::sqrt(0.25f * (vxx - vyy) * (vxx - vyy) + vxy * vxy);
    const float largest = 0.5f * (vxx + vyy) + spread;
    samples.evidence[n] = 1 / (1 + largest / (0.25f * scale * scale));
  }
}

// Follows every patch on the coarsest level. First looked for where the best guess for the whole picture says, or where
// another one fits this patch clearly better: the background must be found even if a large object rates higher, and the
// consensus decides later. Guesses: standing still, the last motion, the coarse search, the head's pose.
Transform CameraMotion::State::follow_from_guesses(int level, const std::array<Shift, 2>& shifts,
                                                   const std::optional<Transform>& prior) {
  constexpr int kGuesses = 5;
  constexpr float kClearly = 0.15f;
  const double coarse = 1 << search_level(reference.size());
  std::array<Transform, kGuesses> guesses{};
  int count = 1;
  if (!last.is_identity()) guesses[count++] = last;
  for (const Shift& s : shifts) guesses[count++] = Transform::translation(s.dx * coarse, s.dy * coarse);
  if (prior && prior->is_sane(reference.size())) guesses[count++] = *prior;
  std::array<std::array<float, kGuesses>, MotionSamples::kMax> fits;
  std::array<float, kGuesses> ratings{};
  for (int i = 0; i < sites.count; ++i) {
    const PatchFollower patch(reference.level(level), level, sites.site[i]);
    for (int g = 0; g < count; ++g) {
      fits[i][g] = look(patch, level, sites.site[i], guesses[g], 0).correlation;
      ratings[g] += std::max(0.0f, fits[i][g] - 0.3f);
    }
  }
  ratings[0] *= 1.05f;  // when in doubt, it stands
  const auto best = std::max_element(ratings.begin(), ratings.begin() + count) - ratings.begin();
  looked_for = 0;
  for (int i = 0; i < sites.count; ++i) {
    const auto own = std::max_element(fits[i].begin(), fits[i].begin() + count) - fits[i].begin();
    const auto from = fits[i][own] > fits[i][best] + kClearly ? own : best;
    const PatchFollower patch(reference.level(level), level, sites.site[i]);
    matches[i] = look(patch, level, sites.site[i], guesses[from], 6);
    looked_for += matches[i].inside;
  }
  return guesses[best];
}

// What is left to be found when the head's turn is taken out first: a turned picture is bent (a homography), and a simple
// model then only has to follow by how much the head's word is wrong.
MotionFit CameraMotion::State::fit_beyond(const Transform& prior, MotionModel model, const Transform& guess,
                                          int hypotheses) {
  beyond = samples;
  for (int i = 0; i < beyond.count; ++i) {
    const Point p = prior.apply({samples.x[i], samples.y[i]});
    beyond.x[i] = static_cast<float>(p.x), beyond.y[i] = static_cast<float>(p.y);
  }
  const std::array guesses{Transform{}, guess * prior.inverse()};
  const MotionFit fit = fit_motion(beyond, model, reference.size(), guesses, hypotheses);
  return rate_motion(samples, fit.transform * prior);
}

// Of the patches whose place can be seen, the share that was found and follows the fit; and the same with each counted
// by how well it was found.
void CameraMotion::State::count_followers(const MotionFit& fit) {
  if (looked_for == 0) return;
  float evidence = 0, well = 0;
  for (int i = 0; i < samples.count; ++i) {
    evidence += samples.evidence[i];
    if (follows(samples, i, fit.transform))
      well += std::clamp((correlations[i] - kFound) / (kFoundWell - kFound), 0.0f, 1.0f);
  }
  if (evidence <= 0) return;
  share = std::max(share, fit.agreeing / evidence * samples.count / looked_for);
  share_well = std::max(share_well, double{well} / looked_for);
}

// A cut: hardly anything of the earlier picture is well found again wherever it is looked for, and the pictures at large
// are unlike. From a picture without texture: texture where there was none. Measured: 1440 pairs of unrelated real
// pictures, share_well at most .20, difference at least .77; 2309 pairs of successive ones, share_well at least .32; half
// the picture replaced: share_well at least .26 in 95 of 100.
bool CameraMotion::State::is_cut(const Shift& shift) const {
  const double before = reference_relief.contrast(), now = current_relief.contrast();
  if (sites.count < kLeastPatches) return now > 3 * before + 1;
  return share_well < 0.22 && (shift.difference > 0.6 || before > 4 * now);
}

bool CameraMotion::State::is_still(const MotionFit& fit) const {
  const double motion = mean_motion(fit.transform, reference.size());
  if (motion < (still ? kStillMotion : 0.1)) return true;
  if (share > 0.9 && motion > 0.5) return false;
  const MotionFit none = rate_motion(samples, {});
  // A large and lively object: the rest of the picture, in many places, says that nothing moves.
  if (motion > 1) return none.support > (still ? 0.6 : 0.85) * fit.support;
  // Too little to tell: the fit explains the samples hardly better than standing still does.
  const double unexplained = fit.agreeing > 1 ? fit.cost / fit.agreeing : 1;
  return none.support > 0.9 * fit.support && none.cost - fit.cost < 12 * std::max(1.0, unexplained);
}

// A motion of the camera shows in many parts of the picture; what moves in a few is an object before a blank wall. A
// camera that stood needs more to be set in motion.
bool CameraMotion::State::is_known(const MotionFit& fit) const {
  std::array<bool, MotionSamples::kRegions> seen{};
  for (int i = 0; i < samples.count; ++i)
    if (follows(samples, i, fit.transform)) seen[samples.region[i]] = true;
  return std::count(seen.begin(), seen.end(), true) >= (still ? 8 : 5);
}

void CameraMotion::State::measure_noise() {
  std::array<float, MotionSamples::kMax> variances;
  int count = 0;
  for (int i = 0; i < sites.count; ++i)
    if (matches[i].correlation >= kFound) variances[count++] = matches[i].noise2;
  if (count < kLeastPatches) return;
  std::nth_element(variances.begin(), variances.begin() + count / 3, variances.begin() + count);
  noise += 0.1 * (std::sqrt(0.5 * variances[count / 3]) - noise);  // both pictures have it
}

// A camera that stood mostly stands: where most patches are found again in their places, on the finest level alone, nothing
// else can come out of the search, which costs five times as much. None where that is not so, or the reference is due.
std::optional<CameraMotionResult> CameraMotion::State::confirm_still() {
  if (!still || !sites_chosen || sites.count < kLeastPatches || reference_age + 1 >= kReferenceAge)
    return std::nullopt;
  const Size size = reference.size();
  follow(0, {});
  collect(0);
  Transform motion;
  refine_motion(samples, std::min(options.model, MotionModel::similarity), size, motion);
  const MotionFit fit = rate_motion(samples, motion);
  share = share_well = 0;
  count_followers(fit);
  if (share < kMajority || mean_motion(motion, size) >= kStillMotion || !is_known(fit)) return std::nullopt;
  measure_noise();
  next_reference(true);
  CameraMotionResult result;
  result.scene_age = ++scene_age;
  result.confidence = share;
  result.residual = rate_motion(samples, {}).residual;
  result.still = true;
  return result;
}

CameraMotionResult CameraMotion::State::estimate(const std::optional<Transform>& prior) {
  const Size size = reference.size();
  if (!sites_chosen) sites.choose(reference, noise, scratch);
  sites_chosen = true;
  const int top = std::max(0, search_level(size) - 1);
  const std::array<Shift, 2> shifts = ShiftSearch{}.run(reference_relief, current_relief);
  Transform motion = follow_from_guesses(top, shifts, prior);
  const bool bent = prior && prior->is_sane(size) && bend(*prior, size) > kBent;
  MotionFit fit;
  share = share_well = 0;
  for (int level = top; level >= 0; --level) {
    // Where the coarsest level agreed, the finest one finds its patches without those in between.
    if (level < top && level > 0 && share > kMajority) continue;
    if (level < top) follow(level, motion);
    collect(level);
    const std::array guesses{Transform{}, motion};
    const MotionModel model = level > 0 ? std::min(options.model, MotionModel::similarity) : options.model;
    const int hypotheses = level == top ? 96 : 24;
    fit = fit_motion(samples, model, size, guesses, hypotheses);
    if (bent && model != MotionModel::none)
      if (const MotionFit turned = fit_beyond(*prior, model, motion, hypotheses);
          turned.support > fit.support)
        fit = turned;
    motion = fit.transform;
    count_followers(fit);
  }
  if (is_cut(shifts[0])) return start_scene();
  measure_noise();
  const bool known = is_known(fit);
  if (!known) fit = rate_motion(samples, prior && prior->is_sane(size) ? *prior : Transform{});
  still = options.model == MotionModel::none || is_still(fit);
  if (still) fit = rate_motion(samples, {});
  CameraMotionResult result;
  result.scene_age = ++scene_age;
  result.transform = last = fit.transform;
  result.confidence = known ? share : 0;
  result.residual = fit.residual;
  result.still = still;
  next_reference(still);
  return result;
}

CameraMotionResult CameraMotion::update(GrayView picture, const std::optional<Transform>& prior) {
  State& s = *state_;
  if (picture.empty()) return {};
  if (s.reference.size() != picture.size()) s.scene_age = 0;
  const int level = search_level(picture.size());
  s.current.build(picture, 1);
  if (s.scene_age > 0)
    if (const auto result = s.confirm_still()) return *result;
  s.current.extend(level + 1);
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
