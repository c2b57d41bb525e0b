// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/turn_division.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::control {

std::optional<Turn> TurnDivision::head(motion::Time taken, const motion::PanTilt& reckoned, double speed,
                                       const std::optional<Turn>& seen) {
  const Parameters& p = parameters_;
  const double step = last_ ? motion::seconds(taken - *last_) : 0;
  last_ = taken;
  if (motion::seconds(taken - span_) >= p.settle) {
    span_ = taken;
    fast_before_ = std::exchange(fast_now_, 0);
  }
  fast_now_ = std::max(fast_now_, speed);
  const double fastest = std::max(fast_now_, fast_before_);
  const bool rests = fastest == 0 && reckoned.pan == 0 && reckoned.tilt == 0;
  if (!(step > 0 && step <= p.longest_step)) {
    rate_ = calm_ = 0;
    base_turns_ = false;
    return rests ? std::nullopt : seen;
  }
  if (seen && std::isfinite(seen->yaw)) {
    const double rate = (seen->yaw - reckoned.pan) / step;
    rate_ += (1 - std::exp(-step / p.smoothing)) * (rate - rate_);
    const double standing = std::max(p.standing, p.share * std::abs(reckoned.pan) / step);
    calm_ = std::abs(rate_) < standing ? calm_ + step : 0;
    if (calm_ >= p.calm) base_turns_ = false;
    if (std::abs(rate_) > p.turning + p.most_error * fastest) base_turns_ = true;
  }
  if (rests) return std::nullopt;
  if (!base_turns_) {
    if (seen && std::isfinite(seen->yaw)) sum(step, reckoned.pan, seen->yaw - reckoned.pan, fastest);
    return seen;
  }
  both_ += step;
  return std::nullopt;
}

void TurnDivision::sum(double step, double reckoned, double difference, double fastest) {
  const Parameters& p = parameters_;
  const double kept = std::exp(-step / p.memory);
  difference_ = kept * difference_ + difference;
  reckoned_ = kept * reckoned_ + reckoned;
  fastest_ = std::max(kept * fastest_, fastest);
  hidden_ = hidden_ || std::abs(difference_) > p.slack + p.explained * std::abs(reckoned_) +
                                                   (1 + p.explained) * p.settle * fastest_;
}

}  // namespace cerberus::control
