// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/manual_override.h"

#include <cmath>
#include <utility>

namespace cerberus::control {

using motion::AxisCommand;

bool ManualOverride::move(double pan, double tilt, bool relative, const motion::Pose& here,
                          const motion::Limits& limits) {
  if (emergency_ || !std::isfinite(pan) || !std::isfinite(tilt)) return false;
  if (relative) {
    const auto base = [&](const AxisCommand& commanded, const motion::AxisState& state) {
      return active_ && commanded.kind == AxisCommand::Kind::position ? commanded.value : state.position;
    };
    pan += base(command_.pan, here.pan);
    tilt += base(command_.tilt, here.tilt);
  }
  const bool inside = limits.pan.holds(pan) && limits.tilt.holds(tilt);
  set(inside ? "manual command: move" : "manual command: move, as far as the limit",
      {.time = {},
       .pan = {AxisCommand::Kind::position, limits.pan.clamp(pan), limits.pan.speed},
       .tilt = {AxisCommand::Kind::position, limits.tilt.clamp(tilt), limits.tilt.speed},
       .order = ++orders_});
  return true;
}

bool ManualOverride::turn(double pan, double tilt) {
  if (emergency_ || !std::isfinite(pan) || !std::isfinite(tilt)) return false;
  const auto axis = [](double speed) {
    return speed == 0 ? AxisCommand{} : AxisCommand{AxisCommand::Kind::velocity, speed, 0};
  };
  set("manual command: turn", {.time = {}, .pan = axis(pan), .tilt = axis(tilt), .order = ++orders_});
  return true;
}

bool ManualOverride::lapse(motion::Time now) {
  if (deadline_ == motion::kNever || now < deadline_) return false;
  expire("its order was not repeated");
  return true;
}

void ManualOverride::emergency(bool pressed) {
  if (pressed == emergency_) return;
  set(pressed ? "the emergency stop is pressed" : "the emergency stop was pressed: it waits for an order",
      {});
  emergency_ = pressed;
}

bool ManualOverride::end() {
  if (emergency_) return false;
  deadline_ = motion::kNever;
  return std::exchange(active_, false);
}

void ManualOverride::set(const char* reason, const drivers::HeadCommand& command) {
  active_ = true;
  deadline_ = motion::kNever;
  command_ = command;
  reason_ = reason;
}

}  // namespace cerberus::control
