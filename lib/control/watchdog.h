// SPDX-License-Identifier: LGPL-2.1-or-later
// Expires when no input has fed it for a time; the head is then stopped. The time is a parameter of every call.
#pragma once

#include "motion/head_limits.h"

namespace cerberus::control {

class Watchdog {
 public:
  // timeout: with zero or less the watchdog never expires.
  void set_timeout(motion::Time timeout) { timeout_ = timeout; }
  // Restarts the timeout: a frame or a command was received at `now`.
  void feed(motion::Time now) {
    fed_ = now;
    alive_ = true;
  }
  // Suspends the watchdog: no input is expected (the head is at rest).
  void rest() { alive_ = false; }
  // Returns whether it was fed and has not expired since.
  bool alive() const { return alive_; }
  // Returns the time of expiry; motion::kNever while it is suspended.
  motion::Time deadline() const {
    return alive_ && timeout_ > motion::Time::zero() && fed_ < motion::kNever - timeout_ ? fed_ + timeout_
                                                                                         : motion::kNever;
  }
  // Returns true once, when the deadline is reached; it is then suspended until it is fed again.
  bool bites(motion::Time now) {
    if (now < deadline() || deadline() == motion::kNever) return false;
    rest();
    return true;
  }

 private:
  motion::Time timeout_{}, fed_{};
  bool alive_ = false;
};

}  // namespace cerberus::control
