// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/height_prior.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {
void HeightPrior::advance(const Transform& motion, Size picture) {
  if (motion.is_identity() || count_ == 0) return;
  const Point middle{picture.width / 2.0, picture.height / 2.0};
  const Point moved = motion.apply(middle);
  const Point lower = motion.apply({middle.x, middle.y + 1});
  const double scale = std::hypot(lower.x - moved.x, lower.y - moved.y), shift = moved.y - middle.y;
  if (!std::isfinite(scale) || !std::isfinite(shift)) return reset();
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
  if (++fresh_ >= std::max<std::size_t>(1, count_ / static_cast<std::size_t>(parameters_.refit))) fit();
}

// The line with most agreement among lines through two samples (M. A. Fischler, R. C. Bolles, "Random sample
// consensus", 1981), then least squares over the samples that agree, with a weak prior on the slope: that of a
// horizon at the picture's upper edge, with a standard deviation of Parameters::slope_spread times itself.
void HeightPrior::fit() {
  const Parameters& q = parameters_;
  fresh_ = 0;
  ready_ = false;
  if (count_ < static_cast<std::size_t>(q.least)) return;
  const auto pick = [&] {
    random_ = random_ * 1664525u + 1013904223u;
    return samples_[(random_ >> 8) % count_];
  };
  const auto agreement = [&](double slope, double offset) {
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double expected = offset + slope * samples_[i].foot;
      const double e = (samples_[i].height - expected) / (q.spread * expected);
      if (expected > 0 && std::abs(e) < q.agree)
        sum += samples_[i].weight * (1 - e * e / (q.agree * q.agree));
    }
    return sum;
  };
  double best = 0, best_slope = 0, best_offset = 0;
  for (int guess = 0; guess < q.guesses; ++guess) {
    const Sample a = pick(), b = pick();
    double slope = a.height / std::max(a.foot, 1.f);  // horizon at the upper edge
    if (guess % q.through_horizon != 0) {
      if (std::abs(a.foot - b.foot) < q.baseline * std::max(a.height, b.height)) continue;
      slope = (a.height - b.height) / (a.foot - b.foot);
    }
    if (slope < 0) continue;
    const double offset = a.height - slope * a.foot, sum = agreement(slope, offset);
    if (sum > best) best = sum, best_slope = slope, best_offset = offset;
  }
  double n = 0, agreed = 0, all = 0, sy = 0, sh = 0, syy = 0, syh = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    all += samples_[i].weight;
    const double y = samples_[i].foot, h = samples_[i].height, expected = best_offset + best_slope * y;
    if (!(expected > 0) || std::abs(h - expected) > q.agree * q.spread * expected) continue;
    agreed += samples_[i].weight;
    n += 1, sy += y, sh += h, syy += y * y, syh += y * h;
  }
  if (n < q.least || agreed < q.share * all) return;
  mean_foot_ = sy / n;
  mean_height_ = sh / n;
  const double variance = q.spread * mean_height_ * q.spread * mean_height_ * q.repeats;
  const double spread = syy - n * mean_foot_ * mean_foot_, joint = syh - n * mean_foot_ * mean_height_;
  const double usual = mean_height_ / std::max(mean_foot_, 1.0);
  const double precision = spread / variance, prior = 1 / (q.slope_spread * usual * q.slope_spread * usual);
  slope_ = std::max((joint / variance + usual * prior) / (precision + prior), 0.0);
  slope_variance_ = 1 / (precision + prior);
  mean_variance_ = variance / n;
  ready_ = true;
}

double HeightPrior::uncertainty(double foot) const {
  const double d = foot - mean_foot_;
  return std::sqrt(mean_variance_ + slope_variance_ * d * d) / (mean_height_ + slope_ * d);
}

double HeightPrior::height(double foot) const {
  const Parameters& q = parameters_;
  if (!ready_) return 0;
  const double d = foot - mean_foot_, h = mean_height_ + slope_ * d;
  if (!(h > 0) || mean_variance_ + slope_variance_ * d * d > q.uncertain * h * q.uncertain * h) return 0;
  return h;
}

}  // namespace cerberus::vision
