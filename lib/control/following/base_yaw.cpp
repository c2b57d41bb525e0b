// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/base_yaw.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::control {

void BaseYaw::on_frame(motion::Time taken, double reported, const std::optional<Turn>& turn,
                       const Head& head) {
  const double dt = taken_ ? motion::seconds(taken - *taken_) : 0;
  if (taken_ && dt <= 0) return;
  taken_ = taken;
  const Head before = std::exchange(head_, head);
  if (dt <= 0 || dt > TargetFilter::kPause) {  // nothing is known of the turn meanwhile
    reported_rate_ = other_rate_ = 0;
    return;
  }
  const bool seen = turn && std::isfinite(turn->yaw);
  yaw_ += reported + (seen ? turn->yaw - (head.pan - before.pan) : 0);
  reported_rate_ = reported / dt;
  const double other = seen ? (turn->yaw - (head.reckoned - before.reckoned)) / dt : 0;
  const double slowness = Parameters{}.slowness * std::max(head.dead_time, dt);
  other_rate_ += (1 - std::exp(-dt / slowness)) * (other - other_rate_);
}

BaseTurn BaseYaw::at(motion::Time effect) const {
  if (!taken_) return {};
  const double rate = reported_rate_ + other_rate_;
  return {yaw_, yaw_ + rate * motion::seconds(effect - *taken_), rate};
}

}  // namespace cerberus::control
