// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/height_prior.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {
namespace {

constexpr double kSpread =
    0.10;  // people and their blobs differ by this share of the height (standard deviation)
constexpr double kAgree = 2.0;       // samples this many deviations from the line agree with it
constexpr double kShare = 0.5;       // of the samples that must
constexpr double kUncertain = 0.16;  // relative standard error of the line beyond which it says nothing
constexpr double kRepeats = 4.0;     // neighbouring frames show the same person: so many samples count as one
constexpr int kGuesses = 40;         // pairs of samples tried as lines
constexpr double kSteepest = 4.0;    // body height / mounting height: a camera at 0.45 m

}  // namespace

void HeightPrior::advance(const Transform& motion, Size picture) {
  if (motion.is_identity() || count_ == 0) return;
  const Point middle{picture.width / 2.0, picture.height / 2.0};
  const Point moved = motion.apply(middle);
  const Point lower = motion.apply({middle.x, middle.y + 1});
  const double scale = std::hypot(lower.x - moved.x, lower.y - moved.y), shift = moved.y - middle.y;
  if (!std::isfinite(scale) || !std::isfinite(shift) || !(scale > 0.5 && scale < 2)) return reset();
  const auto row = [&](double y) { return middle.y + shift + scale * (y - middle.y); };
  for (std::size_t i = 0; i < count_; ++i) {
    samples_[i].foot = static_cast<float>(row(samples_[i].foot));
    samples_[i].height = static_cast<float>(samples_[i].height * scale);
  }
  mean_foot_ = row(mean_foot_);
  mean_height_ *= scale;
  mean_variance_ *= scale * scale;
}

void HeightPrior::learn(double foot, double height, double weight) {
  samples_[next_] = {static_cast<float>(foot), static_cast<float>(height), static_cast<float>(weight)};
  next_ = (next_ + 1) % kCapacity;
  count_ = std::min(count_ + 1, kCapacity);
  // Every sample counts at the start; later the line hardly changes.
  if (++fresh_ >= std::max<std::size_t>(1, count_ / 16)) fit();
}

// The line with most agreement among lines through two samples (M. A. Fischler, R. C. Bolles, "Random sample
// consensus", 1981), then weighted least squares over those who agree, with a weak prior on the slope: a horizon at
// the picture's upper edge, give or take as much again.
void HeightPrior::fit() {
  fresh_ = 0;
  ready_ = false;
  if (count_ < kLeast) return;
  const auto pick = [&] {
    random_ = random_ * 1664525u + 1013904223u;
    return samples_[(random_ >> 8) % count_];
  };
  const auto agreement = [&](double slope, double offset) {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double expected = offset + slope * samples_[i].foot;
      const double e = (samples_[i].height - expected) / (kSpread * expected);
      if (expected > 0 && std::abs(e) < kAgree) sum += samples_[i].weight * (1 - e * e / (kAgree * kAgree));
    }
    return sum;
  };
  double best = 0, best_slope = 0, best_offset = 0;
  for (int guess = 0; guess < kGuesses; ++guess) {
    const Sample a = pick(), b = pick();
    double slope = a.height / std::max(a.foot, 1.f);  // horizon at the upper edge
    if (guess % 4 != 0) {
      if (std::abs(a.foot - b.foot) < 0.2 * std::max(a.height, b.height)) continue;
      slope = (a.height - b.height) / (a.foot - b.foot);
    }
    if (slope < 0 || slope > kSteepest) continue;
    const double offset = a.height - slope * a.foot, sum = agreement(slope, offset);
    if (sum > best) best = sum, best_slope = slope, best_offset = offset;
  }
  double n = 0, agreed = 0, all = 0, sy = 0, sh = 0, syy = 0, syh = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    all += samples_[i].weight;
    const double y = samples_[i].foot, h = samples_[i].height, expected = best_offset + best_slope * y;
    if (!(expected > 0) || std::abs(h - expected) > kAgree * kSpread * expected) continue;
    agreed += samples_[i].weight;
    n += 1, sy += y, sh += h, syy += y * y, syh += y * h;
  }
  if (n < kLeast || agreed < kShare * all) return;
  mean_foot_ = sy / n;
  mean_height_ = sh / n;
  const double variance = kSpread * mean_height_ * kSpread * mean_height_ * kRepeats;
  const double spread = syy - n * mean_foot_ * mean_foot_, joint = syh - n * mean_foot_ * mean_height_;
  const double usual = mean_height_ / std::max(mean_foot_, 1.0);
  const double precision = spread / variance, prior = 1 / (usual * usual);
  slope_ = std::clamp((joint / variance + usual * prior) / (precision + prior), 0.0, kSteepest);
  slope_variance_ = 1 / (precision + prior);
  mean_variance_ = variance / n;
  ready_ = true;
}

double HeightPrior::height(double foot) const {
  if (!ready_) return 0;
  const double d = foot - mean_foot_, h = mean_height_ + slope_ * d;
  if (!(h > 4) || mean_variance_ + slope_variance_ * d * d > kUncertain * h * kUncertain * h) return 0;
  return h;
}

}  // namespace cerberus::vision
