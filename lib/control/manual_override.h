// SPDX-License-Identifier: LGPL-2.1-or-later
// The application's manual command: it takes precedence over every decision until the application ends the override.
#pragma once

#include "drivers/head/head.h"

namespace cerberus::control {

class ManualOverride {
 public:
  bool active() const { return active_; }
  // The two axes as commanded; its time is not set.
  const drivers::HeadCommand& command() const { return command_; }
  const char* reason() const { return reason_; }  // for a user

  // Commands a position, radians, within the limits. relative: from the last commanded position, or from `here` without
  // one. Returns false and changes nothing if a number is not finite.
  bool move(double pan, double tilt, bool relative, const motion::Pose& here, const motion::Limits& limits);
  // Commands the head to brake and stay.
  void stop() { set("told to stop", {}); }
  // Replaces an expired command: the head stays at rest, and no decision moves it.
  void expire(const char* reason) {
    if (active_) set(reason, {});
  }
  // Ends the override. Returns true if it was active.
  bool end();

 private:
  void set(const char* reason, const drivers::HeadCommand& command);

  bool active_ = false;
  drivers::HeadCommand command_;
  const char* reason_ = "";
};

}  // namespace cerberus::control
