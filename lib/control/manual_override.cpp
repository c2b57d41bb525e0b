// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/manual_override.h"

#include <cmath>
#include <utility>

namespace cerberus::control {

using motion::AxisCommand;

bool ManualOverride::move(double pan, double tilt, bool relative, const motion::Pose& here,
                          const motion::Limits& limits) {
  if (!std::isfinite(pan) || !std::isfinite(tilt)) return false;
  if (relative) {
    const auto base = [&](const AxisCommand& commanded, const motion::AxisState& state) {
      return active_ && commanded.kind == AxisCommand::Kind::position ? commanded.value : state.position;
    };
    pan += base(command_.pan, here.pan);
    tilt += base(command_.tilt, here.tilt);
  }
  const bool inside = limits.pan.holds(pan) && limits.tilt.holds(tilt);
  set(inside ? "told to move" : "told to move beyond a limit: as far as it",
      {.time = {},
       .pan = {AxisCommand::Kind::position, limits.pan.clamp(pan), limits.pan.speed},
       .tilt = {AxisCommand::Kind::position, limits.tilt.clamp(tilt), limits.tilt.speed}});
  return true;
}

bool ManualOverride::end() {
  return std::exchange(active_, false);
}

void ManualOverride::set(const char* reason, const drivers::HeadCommand& command) {
  active_ = true;
  command_ = command;
  reason_ = reason;
}

}  // namespace cerberus::control
