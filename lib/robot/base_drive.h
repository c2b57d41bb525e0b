// SPDX-License-Identifier: LGPL-2.1-or-later
// The orders for a robot's base: what line is due, and that a drive ends by itself. Time is a parameter. The protocol:
// docs/manual/base.md.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <string_view>

#include "text/numbers.h"

namespace cerberus::robot {

class BaseDrive {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Parameters {
    std::chrono::milliseconds longest{500};  // a drive that is not repeated; as a turn of the head
    std::chrono::milliseconds repeat{100};   // between two lines; five may be lost before the base stops
    // After an order by hand no request of a head counts. derived: requests that are still on their way, and the pause
    // between two keys
    std::chrono::milliseconds by_hand{2000};
  };

  // By hand. Metres and degrees a second; forwards, and to the right, positive. Both 0: stops.
  void drive(double speed, double yaw_rate, Time now) {
    hand_ = now;
    asked_ = false;
    set(speed, yaw_rate, now);
  }
  void stop(Time now) { drive(0, 0, now); }
  // A head asks for a turn; 0: no more. It ends no order by hand.
  void ask(double yaw_rate, Time now) {
    if (hand_ && now - *hand_ < parameters_.by_hand) return;
    if (yaw_rate == 0 && !asked_) return;
    asked_ = yaw_rate != 0;
    set(0, yaw_rate, now);
  }

  // The line that is due, with its newline; empty: none is.
  std::string line(Time now) {
    if (!active_ || now < due_) return {};
    if (now >= until_ || (speed_ == 0 && yaw_rate_ == 0)) {
      active_ = false;
      return "stop\n";
    }
    due_ = now + parameters_.repeat;
    std::string line = "drive ";
    line.append(text::rounded(speed_, 3).string()).append(" ");
    return line.append(text::rounded(yaw_rate_, 2).string()).append("\n");
  }
  bool is_active() const { return active_; }
  // Metres a second as ordered; 0 once it has stopped.
  double speed() const { return active_ ? speed_ : 0; }

 private:
  void set(double speed, double yaw_rate, Time now) {
    speed_ = speed;
    yaw_rate_ = yaw_rate;
    until_ = now + parameters_.longest;
    // A change waits for the next line: a flood of orders is no flood of lines. A stop does not wait.
    if (!active_ || (speed == 0 && yaw_rate == 0)) due_ = now;
    active_ = true;
  }

  Parameters parameters_;
  double speed_ = 0, yaw_rate_ = 0;
  Time until_{}, due_{};
  std::optional<Time> hand_;  // the last order by hand
  bool active_ = false, asked_ = false;
};

}  // namespace cerberus::robot
