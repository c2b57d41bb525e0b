// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/ego_motion/patch_matches.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// Where no origin stands it is unknown: kept from the first version. Guard of all: bench-camera_motion and
// tests/unit/patch_matches.
constexpr struct Parameters {
  float found = 0.7f;        // correlation of a patch that was found again,
  float found_well = 0.95f;  // and of one that certainly was
  int rounds = 3;            // of matching from one guess
  int rounds_of_many = 6;    // of matching from the best of several guesses
  float worthless = 0.3f;    // correlation up to which a patch does not support a guess
  float first = 1.05f;       // times that the first guess, no motion, counts
  float clearly = 0.15f;     // more correlation than at the common guess: a patch starts from its own
  // Variance of a match.
  float placement =
      0.06f;  // pixels of a picture 320 wide: error without noise. derived: a sixteenth of a pixel
  float unmodelled = 0.02f;     // of the motion: what a simple model cannot describe
  float ridge = 0.01f;          // of the gradient sums: stiffness along an edge
  float least_noise = 0.5f;     // grey levels squared
  float half_evidence = 0.25f;  // pixels squared of the level: variance of a sample that counts half
  int noise_rank = 3;           // 1/n of the patches has less noise than the picture's.
  // Corners of the scene; pixels of a picture 320 wide. measured on the development sequences: by all patches that were
  // found a pan is no calmer than parallax is (medians of calm .65 and .72), by these it is (.83 and .74).
  float sure = 0.1f;  // standard deviation of its place; and at least
  int surest = 16;    // patches. derived: twice those that SceneCalm needs, half of them on objects
} kParameters;

// Matches one patch, starting at the place given by `guess`.
PatchMatch look(const PatchFollower& patch, const Pyramid& current, int level, const PatchSite& site,
                const Transform& guess, int rounds) {
  const float scale = 1.0f / static_cast<float>(1 << level);
  const Point p = guess.apply({site.x, site.y});
  return patch.follow(current.level(level), static_cast<float>(p.x - site.x) * scale,
                      static_cast<float>(p.y - site.y) * scale, rounds);
}

std::uint8_t in_256ths(float place, int side) {
  return static_cast<std::uint8_t>(256 * place / static_cast<float>(side));
}

}  // namespace

PatchFollower PatchMatches::follower(const Pyramid& reference, int level, int i) const {
  return level > 0 ? PatchFollower(reference.level(level), level, sites_.site[i]) : sites_.follower(i);
}

void PatchMatches::follow(const Pyramid& reference, const Pyramid& current, int level,
                          const Transform& guess) {
  looked_for_ = 0;
  for (int i = 0; i < sites_.count; ++i) {
    const PatchSite& site = sites_.site[i];
    matches_[i] = look(follower(reference, level, i), current, level, site, guess, kParameters.rounds);
    looked_for_ += matches_[i].inside;
  }
  collect(reference.size(), level);
}

Transform PatchMatches::follow(const Pyramid& reference, const Pyramid& current, int level,
                               std::span<const Transform> guesses) {
  const Parameters& q = kParameters;
  const std::size_t count = std::min(guesses.size(), kMostGuesses);
  std::array<std::array<float, kMostGuesses>, MotionSamples::kMax> fits;
  std::array<float, kMostGuesses> ratings{};
  for (int i = 0; i < sites_.count; ++i) {
    const PatchFollower patch = follower(reference, level, i);
    for (std::size_t g = 0; g < count; ++g) {
      fits[i][g] = look(patch, current, level, sites_.site[i], guesses[g], 0).correlation;
      ratings[g] += std::max(0.0f, fits[i][g] - q.worthless);
    }
  }
  ratings[0] *= q.first;
  const auto best = std::max_element(ratings.begin(), ratings.begin() + count) - ratings.begin();
  looked_for_ = 0;
  for (int i = 0; i < sites_.count; ++i) {
    const auto own = std::max_element(fits[i].begin(), fits[i].begin() + count) - fits[i].begin();
    const auto from = fits[i][own] > fits[i][best] + q.clearly ? own : best;
    const PatchFollower patch = follower(reference, level, i);
    matches_[i] = look(patch, current, level, sites_.site[i], guesses[from], q.rounds_of_many);
    looked_for_ += matches_[i].inside;
  }
  collect(reference.size(), level);
  return guesses[best];
}

// Turns the matches of one level into samples in level 0 pixels.
void PatchMatches::collect(Size picture, int level) {
  const float scale = static_cast<float>(1 << level), shift = 0.5f * (scale - 1);
  const Parameters& q = kParameters;
  const float placement = q.placement * scale * std::max(1.0f, static_cast<float>(picture.width) / 320);
  samples_.count = 0;
  for (int i = 0; i < sites_.count; ++i) {
    const PatchMatch& m = matches_[i];
    if (m.correlation < q.found) continue;
    const int n = samples_.count++;
    samples_.x[n] = m.x * scale + shift, samples_.y[n] = m.y * scale + shift;
    samples_.u[n] = (m.x + m.dx) * scale + shift, samples_.v[n] = (m.y + m.dy) * scale + shift;
    correlations_[n] = m.correlation;
    samples_.region[n] = sites_.site[i].region;
    // Covariance of the match: noise over gradient information, plus placement, plus the part of the picture's
    // motion that a simple model cannot describe (it grows with the motion).
    const float dx = samples_.u[n] - samples_.x[n], dy = samples_.v[n] - samples_.y[n];
    const float floor = placement * placement + q.unmodelled * q.unmodelled * (dx * dx + dy * dy);
    const float ridge = q.ridge * (m.hxx + m.hyy) + 1;
    const float a = m.hxx + ridge, b = m.hxy, c = m.hyy + ridge;
    const float k = std::max(m.noise2, q.least_noise) * scale * scale / (a * c - b * b);
    const float vxx = c * k + floor, vxy = -b * k, vyy = a * k + floor;
    const float per_determinant = 1 / (vxx * vyy - vxy * vxy);
    samples_.wxx[n] = vyy * per_determinant;
    samples_.wxy[n] = -vxy * per_determinant;
    samples_.wyy[n] = vxx * per_determinant;
    const float spread = std::sqrt(0.25f * (vxx - vyy) * (vxx - vyy) + vxy * vxy);
    const float largest = 0.5f * (vxx + vyy) + spread;
    variances_[n] = largest - floor;
    samples_.evidence[n] = 1 / (1 + largest / (q.half_evidence * scale * scale));
  }
}

PatchMatches::Share PatchMatches::share_of(const MotionFit& fit) const {
  if (looked_for_ == 0) return {};
  float evidence = 0, well = 0;
  for (int i = 0; i < samples_.count; ++i) {
    evidence += samples_.evidence[i];
    if (follows(samples_, i, fit.transform))
      well += std::clamp(
          (correlations_[i] - kParameters.found) / (kParameters.found_well - kParameters.found), 0.0f, 1.0f);
  }
  if (evidence <= 0) return {};
  return {fit.agreeing / evidence * samples_.count / looked_for_, double{well} / looked_for_};
}

SceneCorners PatchMatches::corners(const Transform& motion, Size picture) const {
  const Parameters& q = kParameters;
  const float pixel = std::max(1.0f, static_cast<float>(picture.width) / 320);
  float most = q.sure * q.sure * pixel * pixel;
  if (samples_.count > q.surest) {
    std::array<float, MotionSamples::kMax> sorted = variances_;
    const auto rank = sorted.begin() + q.surest;
    std::nth_element(sorted.begin(), rank, sorted.begin() + samples_.count);
    most = std::max(most, *rank);
  }
  SceneCorners corners;
  corners.reach = 0.5f * kPatch / static_cast<float>(picture.width);
  for (int i = 0; i < samples_.count; ++i) {
    if (variances_[i] >= most && samples_.count > q.surest) continue;
    const Point p = motion.apply({samples_.x[i], samples_.y[i]});
    const bool fits = std::hypot(samples_.u[i] - p.x, samples_.v[i] - p.y) <= kBearable * pixel;
    corners.corner[corners.count++] = {in_256ths(samples_.x[i], picture.width),
                                       in_256ths(samples_.y[i], picture.height), fits};
  }
  return corners;
}

std::optional<double> PatchMatches::noise() const {
  std::array<float, MotionSamples::kMax> variances;
  int count = 0;
  for (int i = 0; i < sites_.count; ++i)
    if (matches_[i].correlation >= kParameters.found) variances[count++] = matches_[i].noise2;
  if (count < kLeast) return std::nullopt;
  const int rank = count / kParameters.noise_rank;
  std::nth_element(variances.begin(), variances.begin() + rank, variances.begin() + count);
  return std::sqrt(0.5 * variances[rank]);  // the residual contains the noise of both pictures
}

}  // namespace cerberus::vision
