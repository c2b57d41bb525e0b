// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/height_line.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

void HeightLine::reset() {
  learnt_ = 0;
}

void HeightLine::move(const Transform& motion) {
  if (motion.is_identity() || learnt_ == 0) return;
  for (std::size_t i = 0; i < std::min(learnt_, kSamples); ++i)
    samples_[i] = {motion.apply(samples_[i].head), motion.apply(samples_[i].foot)};
  middle_ = motion.apply({samples_[0].foot.x, middle_}).y;
}

void HeightLine::learn(const Box& person, const VerificationParameters& p) {
  const double x = person.x + person.width / 2;
  samples_[learnt_++ % kSamples] = {{x, person.y}, {x, person.bottom()}};
  fit(p);
}

// Weighted least squares, the slope drawn towards line_slope; three times, the second and third with less weight for what
// is far from the line (Cauchy's weights).
void HeightLine::fit(const VerificationParameters& p) {
  const std::size_t n = std::min(learnt_, kSamples);
  std::array<double, kSamples> weights;
  for (std::size_t i = 0; i < n; ++i) {
    const double noise = p.line_noise * samples_[i].height();
    weights[i] = 1 / std::max(noise * noise, 1.0);
  }
  std::array<double, kSamples> robust = weights;
  for (int round = 0; round < 3; ++round) {
    double all = 0, rows = 0, heights = 0;
    for (std::size_t i = 0; i < n; ++i) {
      all += robust[i];
      rows += robust[i] * samples_[i].foot.y;
      heights += robust[i] * samples_[i].height();
    }
    middle_ = rows / all, height_ = heights / all;
    const double prior = 1 / (p.line_slope_spread * p.line_slope_spread);
    double spread = prior, shared = prior * p.line_slope;
    for (std::size_t i = 0; i < n; ++i) {
      const double y = samples_[i].foot.y - middle_;
      spread += robust[i] * y * y;
      shared += robust[i] * y * (samples_[i].height() - height_);
    }
    slope_ = shared / spread;
    height_variance_ = 1 / all, slope_variance_ = 1 / spread;
    for (std::size_t i = 0; i < n; ++i) {
      const double away = samples_[i].height() - height_ - slope_ * (samples_[i].foot.y - middle_);
      robust[i] = weights[i] / (1 + weights[i] * away * away / 4);
    }
  }
}

HeightLine::Fit HeightLine::judge(const Box& person, const VerificationParameters& p) const {
  if (learnt_ < static_cast<std::size_t>(p.line_least)) return Fit::unknown;
  const double y = person.bottom() - middle_;
  const double expected = height_ + slope_ * y;
  const double doubt = std::sqrt(height_variance_ + slope_variance_ * y * y);
  if (expected <= 0 || doubt > p.line_doubt * expected) return Fit::unknown;
  return std::abs(std::log(person.height / expected)) < p.line_tolerance ? Fit::fits : Fit::contradicts;
}

}  // namespace cerberus::vision
