// SPDX-License-Identifier: LGPL-2.1-or-later
// What the application orders by hand.
#include <cmath>
#include <utility>

#include "head_controller.hpp"

namespace cerberus::plugin {

using drivers::HeadCommand;
using motion::AxisCommand;
using motion::Pose;

bool HeadController::override(const char* reason, const HeadCommand& command, std::optional<Time> at,
                              DeferredNotifications& out) {
  manual_ = true;
  wanted_ = command;
  hand_ = reason;
  law_.reset();
  const Time now = at && clock_driven_ ? head_time(*at) : told_;
  if (clock_driven_ && !halted_) runner_->command({now, command.pan, command.tilt});
  say("manual", reason, now, out);
  return true;
}

bool HeadController::move(double pan, double tilt, bool relative, std::optional<Time> at,
                          DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_ || ended_ || !std::isfinite(pan) || !std::isfinite(tilt)) return false;
  if (relative) {
    const Time now = at && clock_driven_ ? head_time(*at) : std::max(told_, published_);
    const Pose here = history_.at(now);
    const auto base = [&](const AxisCommand& wanted, const motion::AxisState& state) {
      return manual_ && wanted.kind == AxisCommand::Kind::position ? wanted.value : state.position;
    };
    pan += base(wanted_.pan, here.pan);
    tilt += base(wanted_.tilt, here.tilt);
  }
  const motion::Limits& limits = setup_.limits;
  const bool inside = limits.pan.holds(pan) && limits.tilt.holds(tilt);
  HeadCommand command;
  command.pan = {AxisCommand::Kind::position, limits.pan.clamp(pan), limits.pan.speed};
  command.tilt = {AxisCommand::Kind::position, limits.tilt.clamp(tilt), limits.tilt.speed};
  return override(inside ? "told to move" : "told to move beyond a limit: as far as it", command, at, out);
}

bool HeadController::stay(std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  return runner_ && override("told to stop", {}, at, out);
}

// From the application's hand to what the frames say.
void HeadController::give_back(const char* reason, std::optional<Time> at, DeferredNotifications& out) {
  if (!std::exchange(manual_, false)) return;
  const Time now = at && clock_driven_ ? head_time(*at) : told_;
  if (clock_driven_ && !halted_) runner_->command({now, {}, {}});
  say("holding", reason, now, out);
}

bool HeadController::automatic(std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_) return false;
  pilot_.follow(0);
  give_back("told to go on by itself", at, out);
  return true;
}

bool HeadController::follow(guint id, std::optional<Time> at, DeferredNotifications& out) {
  const std::lock_guard guard(lock_);
  if (!runner_ || ended_ || id == 0) return false;
  pilot_.follow(id);
  law_.reset();  // somebody new
  give_back("told to follow somebody", at, out);
  return true;
}

}  // namespace cerberus::plugin
