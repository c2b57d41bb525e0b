// SPDX-License-Identifier: LGPL-2.1-or-later
// A head stops when commands stop coming. Time is a parameter.
#pragma once

#include "control/head_limits.h"

namespace cerberus::control {

class Watchdog {
 public:
  // timeout: zero or less never bites.
  void set_timeout(Time timeout) { timeout_ = timeout; }
  // Somebody who knows what the head is to do was heard at `now`.
  void feed(Time now) {
    fed_ = now;
    alive_ = true;
  }
  // Nobody is expected to speak (the head stands still).
  void rest() { alive_ = false; }
  // It was fed, and has not bitten since.
  bool alive() const { return alive_; }
  // When it will bite; kNever while it rests.
  Time deadline() const {
    return alive_ && timeout_ > Time::zero() && fed_ < kNever - timeout_ ? fed_ + timeout_ : kNever;
  }
  // True once, when the deadline is reached; then it rests until it is fed again.
  bool bites(Time now) {
    if (now < deadline() || deadline() == kNever) return false;
    rest();
    return true;
  }

 private:
  Time timeout_{}, fed_{};
  bool alive_ = false;
};

}  // namespace cerberus::control
