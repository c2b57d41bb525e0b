// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/approach.h"

#include <algorithm>
#include <cmath>

#include "sensing/angles.h"

namespace cerberus::drivers::onvif {

using motion::AxisCommand;
using sensing::degrees;

double approach(const AxisCommand& command, const motion::AxisLimits& limits, std::optional<double> at,
                bool needs_position, const ApproachParameters& parameters) {
  if (command.kind == AxisCommand::Kind::hold || !std::isfinite(command.value)) return 0;
  const double wanted = degrees(command.value), from = degrees(limits.from), to = degrees(limits.to);
  const bool to_angle = command.kind == AxisCommand::Kind::position;
  if (!at) return to_angle || needs_position ? 0 : wanted;
  if (to_angle) {
    const double off = std::clamp(wanted, from, to) - *at;
    const double most = degrees(command.speed > 0 ? std::min(command.speed, limits.speed) : limits.speed);
    return std::abs(off) < parameters.arrived ? 0 : std::clamp(parameters.position_gain * off, -most, most);
  }
  const double left = wanted > 0 ? to - *at : *at - from;
  if (left < parameters.arrived) return 0;
  return std::copysign(std::min(std::abs(wanted), left / parameters.limit_horizon), wanted);
}

}  // namespace cerberus::drivers::onvif
