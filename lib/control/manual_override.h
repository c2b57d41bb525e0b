// SPDX-License-Identifier: LGPL-2.1-or-later
// The command that the application gave itself: it goes before every decision until the application gives the head back.
#pragma once

#include "drivers/head/head.h"

namespace cerberus::control {

class ManualOverride {
 public:
  bool active() const { return active_; }
  // The two axes as commanded; its time is not set.
  const drivers::HeadCommand& command() const { return command_; }
  const char* reason() const { return reason_; }  // for a user

  // To pan, tilt in radians, as far as the limits allow. relative: from the position that was commanded last, or from
  // `here` without one. False, and nothing changes: a number is not finite.
  bool move(double pan, double tilt, bool relative, const motion::Pose& here, const motion::Limits& limits);
  // The head brakes and stays.
  void stop() { set("told to stop", {}); }
  // The command has expired: the head stands still, and no decision moves it.
  void expire(const char* reason) {
    if (active_) set(reason, {});
  }
  // The decisions count again. True: they did not before.
  bool end();

 private:
  void set(const char* reason, const drivers::HeadCommand& command);

  bool active_ = false;
  drivers::HeadCommand command_;
  const char* reason_ = "";
};

}  // namespace cerberus::control
