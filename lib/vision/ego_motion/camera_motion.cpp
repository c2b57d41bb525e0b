// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/camera_motion.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "vision/ego_motion/camera_motion_parameters.h"
#include "vision/ego_motion/global_shift.h"
#include "vision/ego_motion/patch_matches.h"
#include "vision/image/pyramid.h"

namespace cerberus::vision {

namespace {

constexpr CameraMotionParameters kParameters;

int search_level(Size size) {
  int level = 0;
  while (std::max(size.width, size.height) >> level > Relief::kMaxSide) ++level;
  return level;
}

// Returns the coarsest level on which patches are searched.
int top_level(Size size) {
  return std::max(0, search_level(size) - 1);
}

// Returns the RMS displacement over a grid of the picture, pixels: the length of an equivalent shift.
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

// Returns by how many pixels, at most, a homography bends the picture, which a simpler model cannot follow.
double bend(const Transform& t, Size size) {
  return 0.25 * (std::abs(t.m[6]) * size.width + std::abs(t.m[7]) * size.height) *
         std::max(size.width, size.height);
}

}  // namespace

// The reference is frame k-1 while the camera moves. While the camera is still, the reference is kept for
// CameraMotionParameters::reference_age frames, so that a motion too slow to be measured from frame to frame accumulates until it is measured.
struct CameraMotion::State {
  CameraMotionOptions options;
  Pyramid reference, current;  // current: of the caller's picture, valid only during update()
  Relief reference_relief, current_relief;
  PatchSites sites;               // of the reference
  std::span<const Box> excluded;  // of the caller, valid only during update()
  Image<std::int32_t> scratch;
  int reference_age = 0;      // frames since the reference
  PatchMatches::Share share;  // of the fit, on the level where it is highest
  Transform last;             // frame k-2 to k-1
  LensBend lens;
  double noise = 1;  // standard deviation of a pixel
  bool still = false;
  // Remaining frames for which a moving camera is assumed to keep moving although the picture has too few matches.
  int on_its_way = 0;
  int scene_age = 0;

  std::optional<CameraMotionResult> confirm_still();
  CameraMotionResult estimate(const std::optional<Transform>& prior);
  CameraMotionResult start_scene();
  // matches, samples: from the reference to the current picture.
  Transform first_guess(PatchMatches& matches, int level, const std::array<Shift, 2>& shifts,
                        const std::optional<Transform>& prior) const;
  MotionFit fit_on(int level, const MotionSamples& samples, std::span<const Transform> guesses,
                   const LensBend& known) const;
  MotionFit fit_beyond(const Transform& prior, int level, const MotionSamples& samples,
                       const Transform& guess) const;
  MotionFit best_without(const MotionSamples& samples, const std::optional<Transform>& prior) const;
  void count_followers(const PatchMatches& matches, const MotionFit& fit);
  bool is_cut(const Shift& shift) const;
  PatchMatches found_in_place() const;
  std::optional<MotionFit> standing(const MotionSamples& samples, const MotionFit& fit) const;
  bool is_known(const MotionSamples& samples, const MotionFit& fit) const;
  bool leaves_behind(const MotionFit& fit) const;
  void measure_noise(const PatchMatches& matches);
  void next_reference(bool keep);
};

CameraMotion::CameraMotion() : state_(std::make_unique<State>()) {}
CameraMotion::~CameraMotion() = default;
CameraMotion::CameraMotion(CameraMotion&&) noexcept = default;
CameraMotion& CameraMotion::operator=(CameraMotion&&) noexcept = default;

void CameraMotion::set_options(const CameraMotionOptions& options) {
  state_->options = options;
  if (options.model == MotionModel::none) state_->on_its_way = 0;
}

void CameraMotion::reset() {
  state_->scene_age = 0;
}

std::size_t CameraMotion::bytes() const {
  return sizeof(State) + state_->reference.bytes() + state_->current.bytes() + state_->scratch.bytes() +
         state_->sites.bytes() + state_->reference_relief.bytes() + state_->current_relief.bytes();
}

void CameraMotion::State::next_reference(bool keep) {
  if (keep && ++reference_age < kParameters.reference_age) return;
  sites.choose(current, noise, scratch, excluded);
  reference.take(current);
  std::swap(reference_relief, current_relief);
  reference_age = 0;
}

CameraMotionResult CameraMotion::State::start_scene() {
  next_reference(false);
  still = false;
  on_its_way = 0;
  lens = {};
  last = {};
  scene_age = 1;
  CameraMotionResult result;
  result.scene_age = 1;
  return result;
}

// Matches every patch on the coarsest level. Guesses: no motion, the last motion, the coarse search, the prior from the
// head's pose.
Transform CameraMotion::State::first_guess(PatchMatches& matches, int level,
                                           const std::array<Shift, 2>& shifts,
                                           const std::optional<Transform>& prior) const {
  const double coarse = 1 << search_level(reference.size());
  std::array<Transform, PatchMatches::kMostGuesses> guesses{};
  std::size_t count = 1;
  if (!last.is_identity()) guesses[count++] = last;
  for (const Shift& s : shifts) guesses[count++] = Transform::translation(s.dx * coarse, s.dy * coarse);
  if (prior) guesses[count++] = *prior;
  return matches.follow(reference, current, level, std::span(guesses).first(count));
}

void CameraMotion::State::count_followers(const PatchMatches& matches, const MotionFit& fit) {
  const PatchMatches::Share of = matches.share_of(fit);
  share = {std::max(share.all, of.all), std::max(share.well, of.well)};
}

void CameraMotion::State::measure_noise(const PatchMatches& matches) {
  if (const auto measured = matches.noise()) noise += kParameters.noise_share * (*measured - noise);
}

MotionFit CameraMotion::State::fit_on(int level, const MotionSamples& samples,
                                      std::span<const Transform> guesses, const LensBend& known) const {
  const CameraMotionParameters& q = kParameters;
  const Size size = reference.size();
  const MotionModel model = level > 0 ? std::min(options.model, MotionModel::similarity) : options.model;
  const bool top = level == top_level(size);  // finer levels start from its result
  const MotionFit fit = fit_motion(samples, model, size, guesses, top ? q.hypotheses : q.finer_hypotheses,
                                   top ? q.finer_hypotheses : 0, known);
  // On a coarse level a turn is fitted only if its bend would mislead the finer levels: their search covers a few
  // pixels around the guess.
  const bool turns =
      model == MotionModel::similarity && (level == 0 || !fit.transform.is_affine() ||
                                           mean_motion(fit.transform, size) > q.large_motion * (1 << level));
  if (!turns) return fit;
  MotionFit turned = fit_turn(samples, size, fit, known);
  turned.rival = fit.rival;
  return turned;
}

// Fits the motion that remains after the prior from the head's pose is removed. A turn bends the picture (a
// homography); a simple model then only has to describe the error of the prior.
MotionFit CameraMotion::State::fit_beyond(const Transform& prior, int level, const MotionSamples& samples,
                                          const Transform& guess) const {
  MotionSamples beyond = samples;
  for (int i = 0; i < beyond.count; ++i) {
    const Point p = prior.apply({samples.x[i], samples.y[i]});
    beyond.x[i] = static_cast<float>(p.x), beyond.y[i] = static_cast<float>(p.y);
  }
  const std::array guesses{Transform{}, guess * prior.inverse()};
  return rate_motion(samples, fit_on(level, beyond, guesses, {}).transform * prior);
}

// Returns whether the current picture starts a new scene: hardly any patch of the reference is well matched at any
// guess, and the pictures as a whole differ. After a reference without texture: the current picture has texture.
bool CameraMotion::State::is_cut(const Shift& shift) const {
  const CameraMotionParameters& q = kParameters;
  const double before = reference_relief.contrast(), now = current_relief.contrast();
  if (sites.count < PatchMatches::kLeast) return now > q.cut_contrast * before + 1;
  return share.well < q.cut_share && (shift.difference > q.cut_difference || before > q.cut_contrast * now);
}

// Matches every patch at its own place on the finest level. The matches of estimate() do not suffice: they were
// searched at the end of a motion, and a patch that has not moved is not found there.
PatchMatches CameraMotion::State::found_in_place() const {
  PatchMatches matches(sites);
  matches.follow(reference, current, 0, Transform{});
  return matches;
}

// Returns the rating of no motion if the camera stands, else nullopt. For a camera that was still, the patches are
// matched again in place before a larger motion is accepted: repeated texture, such as floor boards, matches at
// several places and seems to follow a person walking over it.
std::optional<MotionFit> CameraMotion::State::standing(const MotionSamples& samples,
                                                       const MotionFit& fit) const {
  const CameraMotionParameters& q = kParameters;
  if (options.model == MotionModel::none) return rate_motion(samples, {});
  const double motion = mean_motion(fit.transform, reference.size());
  if (share.all > q.nearly_all && motion > q.certain_motion) return std::nullopt;
  const bool anew = still && motion > q.large_motion;
  const MotionFit none = anew ? rate_motion(found_in_place().samples(), {}) : rate_motion(samples, {});
  const auto stands = [&] {
    if (motion < (still ? q.still_motion : q.least_motion)) return true;
    // For a large motion the regions that agree are compared: if a large object moves, the rest of the picture supports
    // no motion in many places.
    const bool contested = fit.rival.has_value();
    const double here = contested ? none.ground : none.support, there = contested ? fit.ground : fit.support;
    if (motion > q.large_motion) return here > (still ? q.majority : q.nearly_all) * there;
    // Leaving "still" needs strong support; slow motion accumulates against the kept reference.
    if (still && (contested || share.all < q.majority)) return true;
    // A small motion counts as none if it explains the samples hardly better than no motion does.
    const double unexplained = fit.agreeing > 1 ? fit.cost / fit.agreeing : 1;
    return none.support > q.nearly_all * fit.support &&
           none.cost - fit.cost < q.worth * std::max(1.0, unexplained);
  };
  return stands() ? std::optional(none) : std::nullopt;
}

// Returns whether enough parts of the picture follow `fit` for it to be the camera's motion. The camera's motion shows
// in many parts of the picture; a motion in a few parts is that of an object before a blank wall. A moving camera needs
// few_parts, or wide_columns columns of parts. A still camera needs many_parts; between few_parts and
// many_parts the followers must be spread wider than an object seen in so few parts (the few objects on a bare wall),
// and no patch may be left behind.
bool CameraMotion::State::is_known(const MotionSamples& samples, const MotionFit& fit) const {
  const CameraMotionParameters& q = kParameters;
  std::bitset<MotionSamples::kRegions> seen;
  std::array<float, MotionSamples::kMax> across;
  int following = 0;
  for (int i = 0; i < samples.count; ++i)
    if (follows(samples, i, fit.transform)) seen.set(samples.region[i]), across[following++] = samples.x[i];
  const int parts = static_cast<int>(seen.count());
  if (!still) {
    const auto columns =
        (seen | seen >> 4 | seen >> 8 | seen >> 12) & std::bitset<MotionSamples::kRegions>(0xf);
    return parts >= q.few_parts || static_cast<int>(columns.count()) >= q.wide_columns;
  }
  if (parts < q.few_parts || parts >= q.many_parts) return parts >= q.many_parts;
  // The width of the middle four fifths of the followers, because single matches may be wrong.
  const int tenth = following / 10;
  const auto place = [&](int rank) {
    std::nth_element(across.begin(), across.begin() + rank, across.begin() + following);
    return across[rank];
  };
  const float width = place(following - 1 - tenth) - place(tenth);
  return width > q.wide * static_cast<float>(reference.size().width) && !leaves_behind(fit);
}

// Returns whether more than one patch is found in its old place and does not follow `fit`. A single one may be wrong.
bool CameraMotion::State::leaves_behind(const MotionFit& fit) const {
  const PatchMatches matches = found_in_place();
  const MotionSamples& samples = matches.samples();
  int count = 0;
  for (int i = 0; i < samples.count; ++i)
    count += follows(samples, i, {}) && !follows(samples, i, fit.transform);
  return count > 1;
}

// Returns the result for a camera that remains still, or nullopt if the full search is needed. A still camera mostly
// remains still: if most patches are found in their places on the finest level, the full search, which costs five
// times as much, cannot give another result. Returns nullopt also when the reference is due for renewal.
std::optional<CameraMotionResult> CameraMotion::State::confirm_still() {
  if (!still || reference_age == 0 || sites.count < PatchMatches::kLeast ||
      reference_age + 1 >= kParameters.reference_age)
    return std::nullopt;
  const Size size = reference.size();
  const PatchMatches matches = found_in_place();
  Transform motion;
  refine_motion(matches.samples(), std::min(options.model, MotionModel::similarity), size, motion);
  const MotionFit fit = rate_motion(matches.samples(), motion);
  share = {};
  count_followers(matches, fit);
  if (share.all < kParameters.majority || mean_motion(motion, size) >= kParameters.still_motion ||
      !is_known(matches.samples(), fit))
    return std::nullopt;
  measure_noise(matches);
  CameraMotionResult result;
  result.corners = matches.corners({}, size);
  next_reference(true);
  result.scene_age = ++scene_age;
  result.confidence = share.all;
  result.residual = rate_motion(matches.samples(), {}).residual;
  result.still = true;
  return result;
}

// Returns the motion for a picture with too few matches: the prior if there is one; else no motion or, for a camera
// that was moving, its last motion, whichever has more support.
MotionFit CameraMotion::State::best_without(const MotionSamples& samples,
                                            const std::optional<Transform>& prior) const {
  if (prior) return rate_motion(samples, *prior);
  const MotionFit stands = rate_motion(samples, {}), goes_on = rate_motion(samples, last);
  return on_its_way > 0 && goes_on.support > stands.support ? goes_on : stands;
}

CameraMotionResult CameraMotion::State::estimate(const std::optional<Transform>& prior) {
  const Size size = reference.size();
  PatchMatches matches(sites);
  const int top = top_level(size);
  const std::array<Shift, 2> shifts = ShiftSearch{}.run(reference_relief, current_relief);
  Transform motion = first_guess(matches, top, shifts, prior);
  const bool bent = prior && bend(*prior, size) > kParameters.still_motion;
  MotionFit fit;
  std::optional<Transform> rival;  // second guess for the patches of the next level
  share = {};
  for (int level = top; level >= 0; --level) {
    // After agreement on the coarsest level the levels in between are skipped: the finest one finds its patches.
    if (level < top && level > 0 && share.all > kParameters.majority) continue;
    if (level < top && rival)
      matches.follow(reference, current, level, std::array{motion, *rival});
    else if (level < top)
      matches.follow(reference, current, level, motion);
    fit = fit_on(level, matches.samples(), std::array{Transform{}, motion}, lens);
    rival = fit.rival;
    if (bent && options.model != MotionModel::none)
      if (const MotionFit turned = fit_beyond(*prior, level, matches.samples(), motion);
          turned.support > fit.support)
        fit = turned;
    motion = fit.transform;
    count_followers(matches, fit);
  }
  if (is_cut(shifts[0])) return start_scene();
  measure_noise(matches);
  const bool known = is_known(matches.samples(), fit);
  if (!known) fit = best_without(matches.samples(), prior);
  const bool lost = !known && !prior && on_its_way > 0;
  const auto stands = lost ? std::nullopt : standing(matches.samples(), fit);
  still = stands.has_value();
  if (still) fit = *stands;
  on_its_way = still ? 0 : !fit.transform.is_identity() ? kParameters.goes_on : std::max(0, on_its_way - 1);
  lens.learn(fit.lens);
  CameraMotionResult result;
  result.scene_age = ++scene_age;
  result.transform = last = fit.transform;
  result.confidence = known ? share.all : 0;
  result.residual = fit.residual;
  result.still = still;
  result.corners = matches.corners(fit.transform, size);
  next_reference(still);
  return result;
}

CameraMotionResult CameraMotion::update(GrayView picture, const std::optional<Transform>& prior,
                                        std::span<const Box> excluded) {
  State& s = *state_;
  if (picture.empty()) return {};
  if (s.reference.size() != picture.size()) s.scene_age = 0;
  const int level = search_level(picture.size());
  s.excluded = excluded;
  s.sites.exclude(excluded);
  s.current.borrow(picture, 1);
  if (s.scene_age > 0)
    if (const auto result = s.confirm_still()) return *result;
  s.current.extend(level + 1);
  s.current_relief.build(s.current.level(std::min(level, s.current.levels() - 1)));
  if (s.scene_age == 0) return s.start_scene();
  if (std::min(picture.width, picture.height) < kParameters.least_side) {
    const int age = s.scene_age + 1;
    CameraMotionResult result = s.start_scene();
    result.scene_age = s.scene_age = age;
    result.still = true;
    return result;
  }
  return s.estimate(prior && prior->is_sane(picture.size()) ? prior : std::nullopt);
}

}  // namespace cerberus::vision
