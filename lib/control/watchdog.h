// SPDX-License-Identifier: LGPL-2.1-or-later
// A head stops when commands stop coming. motion::Time is a parameter.
#pragma once

#include "motion/head_limits.h"

namespace cerberus::control {

class Watchdog {
 public:
  // timeout: zero or less never bites.
  void set_timeout(motion::Time timeout) { timeout_ = timeout; }
  // Somebody who knows what the head is to do was heard at `now`.
  void feed(motion::Time now) {
    fed_ = now;
    alive_ = true;
  }
  // Nobody is expected to speak (the head stands still).
  void rest() { alive_ = false; }
  // It was fed, and has not bitten since.
  bool alive() const { return alive_; }
  // When it will bite; motion::kNever while it rests.
  motion::Time deadline() const {
    return alive_ && timeout_ > motion::Time::zero() && fed_ < motion::kNever - timeout_ ? fed_ + timeout_
                                                                                         : motion::kNever;
  }
  // True once, when the deadline is reached; then it rests until it is fed again.
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
