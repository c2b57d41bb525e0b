// SPDX-License-Identifier: LGPL-2.1-or-later
// Which controller has the head: the emergency stop before the application's manual commands before the decisions.
//
// A manual command holds until the application ends the override, or expires where it has a deadline. A stop latches:
// only a new manual command or the end of the override moves the head again. The same holds after an emergency stop,
// and while that lasts every command is refused.
#pragma once

#include <cstdint>

#include "drivers/head/head.h"

namespace cerberus::control {

enum class Authority : std::uint8_t { automatic, manual, emergency_stop };

class ManualOverride {
 public:
  bool active() const { return active_; }
  Authority authority() const {
    return emergency_ ? Authority::emergency_stop : active_ ? Authority::manual : Authority::automatic;
  }
  // The two axes as commanded; its time is not set. A move and a turn have an order's number each.
  const drivers::HeadCommand& command() const { return command_; }
  const char* reason() const { return reason_; }  // for a user
  // The head stands, and nothing but the next command or the end of the override moves it.
  bool waits_for_order() const { return active_ && command_.order == 0; }

  // Commands a position, radians, within the limits. relative: from the last commanded position, or from `here` without
  // one. Returns false and changes nothing if a number is not finite, or during an emergency stop.
  bool move(double pan, double tilt, bool relative, const motion::Pose& here, const motion::Limits& limits);
  // Commands speeds, radians a second, as far as the limits. Returns false as move() does.
  bool turn(double pan, double tilt);
  // The last command is replaced by a stop at `deadline` unless another one comes before.
  void expires(motion::Time deadline) { deadline_ = deadline; }
  motion::Time deadline() const { return deadline_; }  // motion::kNever: none
  // Returns true once, when the deadline is reached; the head is then commanded to stay.
  bool lapse(motion::Time now);
  // Commands the head to brake and stay.
  void stop() {
    if (!emergency_) set("manual command: stop", kStop);
  }
  // The head stays where it is until the next command, or the end of the override.
  void wait(const char* reason) {
    if (!emergency_) set(reason, kStop);
  }
  // The emergency stop was pressed or released.
  void emergency(bool pressed);
  // Replaces an expired command: the head stays at rest, and no decision moves it.
  void expire(const char* reason) {
    if (active_ && !emergency_) set(reason, kStop);
  }
  // Ends the override. Returns true if it was active; it is not ended during an emergency stop.
  bool end();

 private:
  static constexpr drivers::HeadCommand kStop{.time = {}, .pan = {}, .tilt = {}, .stop = true};
  void set(const char* reason, const drivers::HeadCommand& command);

  bool active_ = false, emergency_ = false;
  motion::Time deadline_ = motion::kNever;
  drivers::HeadCommand command_;
  unsigned orders_ = 0;
  const char* reason_ = "";
};

}  // namespace cerberus::control
