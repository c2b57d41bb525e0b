// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/gyro/gyro_bias.h"

#include <algorithm>
#include <cmath>

namespace cerberus::control {

namespace {

// Evidence that is further apart leaves room for a turn between.
constexpr motion::Time kGap = std::chrono::milliseconds(500);

}  // namespace

void GyroBias::reset() {
  *this = GyroBias(parameters_);
}

std::optional<double> GyroBias::add(Time time, double measured) {
  if (!std::isfinite(measured)) return std::nullopt;
  if (count_ > 0 &&
      time < newest_sample().time) {  // time began anew: nothing before it is evidence of what follows
    count_ = next_ = 0;
    since_.reset();
    reported_.reset();
  }
  samples_[next_] = {time, measured};
  next_ = (next_ + 1) % kKept;
  count_ = std::min(count_ + 1, kKept);
  const bool robot_speaks = reported_ && time - *reported_ < sensing::kBaseLifetime;
  if (!bias_ || robot_speaks) return std::nullopt;
  return measured - *bias_;
}

void GyroBias::frame(Time time, const std::optional<Turn>& turn, bool rests) {
  if (reported_ && time - *reported_ < sensing::kBaseLifetime) return;  // the robot's own word goes first
  if (!rests || !turn || !(std::hypot(turn->yaw, turn->pitch) <= parameters_.frame_turn)) {
    since_.reset();
    return;
  }
  turned_ = {turned_.yaw + turn->yaw, turned_.pitch + turn->pitch};
  stands(time);
}

void GyroBias::robot(Time time, double rate) {
  reported_ = time;
  if (rate == 0)
    stands(time);
  else
    since_.reset();
}

void GyroBias::stands(Time time) {
  if (!since_ || time < newest_ || time - newest_ > kGap) {
    since_ = time;
    turned_ = {};
  }
  newest_ = time;
  if (time - *since_ < parameters_.span) return;
  if (std::hypot(turned_.yaw, turned_.pitch) <= parameters_.span_turn) learn(*since_, time);
  since_ = time;
  turned_ = {};
}

void GyroBias::learn(Time from, Time until) {
  double sum = 0, squares = 0;
  unsigned n = 0;
  for (unsigned i = 0; i < count_; ++i) {
    const Sample& sample = samples_[i];
    if (sample.time < from || sample.time > until) continue;
    // Relative to the newest sample: a large bias must not drown the spread.
    const double rate = sample.rate - newest_sample().rate;
    sum += rate;
    squares += rate * rate;
    ++n;
  }
  constexpr unsigned kLeast = 10;  // below it a spread says little
  if (n < kLeast) return;
  const double mean = sum / n, variance = squares / n - mean * mean;
  const double found = mean + newest_sample().rate;
  if (variance > parameters_.rest * parameters_.rest || std::abs(found) > parameters_.most) return;
  bias_ = bias_ ? *bias_ + parameters_.blend * (found - *bias_) : found;
}

}  // namespace cerberus::control
