// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/timeout_trial.h"

#include <algorithm>
#include <cmath>

#include "sensing/angles.h"

namespace cerberus::control {

std::optional<TimeoutTrial> plan_timeout_trial(const motion::SpeedMap& speeds, double position, double reach,
                                               const TimeoutTrialParameters& parameters) {
  const double room = reach + std::abs(position);  // towards the farther end
  const double longest = parameters.lead + parameters.patience + parameters.restart;
  for (const double degrees : parameters.speeds) {
    const double speed = sensing::radians(degrees);
    if (std::max(speed, std::abs(speeds.actual(speed))) * longest > room) continue;
    return TimeoutTrial{position > 0 ? -speed : speed, parameters.lead};
  }
  return std::nullopt;
}

void TimeoutWatch::add(double now, double turn) {
  if (!std::isfinite(turn)) return;
  position_ += turn;
  if (std::abs(turn) <= parameters_.least * std::abs(trial_.speed)) return;
  moved_ = now;
  seen_ = seen_ || !killed_;
}

TimeoutWatch::End TimeoutWatch::end(double now) const {
  if (key_) return End::key;
  if (std::abs(position_) >= reach_) return End::turns;
  if (!killed_) return End::none;
  if (!seen_) return End::unseen;
  if (now - moved_ >= parameters_.still) return End::stopped;
  return now - *killed_ >= parameters_.patience ? End::turns : End::none;
}

}  // namespace cerberus::control
