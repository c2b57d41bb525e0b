// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/trials/timeout_trial.h"

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
  if (!std::isfinite(turn)) {
    // A head that is not seen does not rest.
    if (now - measured_ >= parameters_.still) still_frames_ = 0;
    return;
  }
  position_ += turn;
  measured_ = now;
  turned_ = std::abs(turn) > parameters_.least * std::abs(trial_.speed);
  if (turned_)
    still_frames_ = 0;
  else if (killed_ && still_frames_++ == 0)
    still_from_ = now;
  if (!killed_) seen_ = seen_ || turned_;
}

TimeoutWatch::End TimeoutWatch::end(double now) const {
  if (key_) return End::key;
  if (std::abs(position_) >= reach_) return End::turns;
  if (!killed_) return End::none;
  if (!seen_) return End::unseen;
  if (still_frames_ >= parameters_.frames && measured_ - still_from_ >= parameters_.still)
    return End::stopped;
  if (now - *killed_ < parameters_.patience) return End::none;
  return turned_ && measured_ > *killed_ ? End::turns : End::unseen;
}

}  // namespace cerberus::control
