// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/emergency_stop.h"

#include <algorithm>
#include <cstring>

namespace cerberus::drivers {

std::string EmergencyStop::open(const HeadSetup& setup, Time now) {
  if (std::string wrong = port_->open({}, {}, {line_}); !wrong.empty()) return "the emergency stop: " + wrong;
  if (std::string wrong = device_.open(setup, now); !wrong.empty()) return wrong;
  tick(now);
  return {};
}

void EmergencyStop::move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) {
  if (!open_) device_.move(pan, tilt, now);
}

void EmergencyStop::limit(const motion::Limits& limits, Time now) {
  device_.limit(limits, now);
  if (open_) device_.release(now);  // limits make a head beyond them return
}

Time EmergencyStop::tick(Time now) {
  bool level = true;
  if (error_ != 0) reopen(now);
  error_ = port_->get(0, level);
  if (error_ != 0 || level) {  // a line that cannot be read counts as open
    if (!open_) device_.release(now);
    open_ = true;
    if (error_ == 0) next_open_ = now;
    open_until_ = now + kClosed;
  } else if (now >= open_until_) {
    open_ = false;
  }
  return std::min(device_.tick(now), now + Time(kPeriod));
}

// The chip may have been unplugged and be there again: its line must then be requested anew.
void EmergencyStop::reopen(Time now) {
  if (now < next_open_) return;
  next_open_ = now + kReopen;
  port_->close();
  port_->open({}, {}, {line_});
}

void EmergencyStop::watch(std::vector<pollfd>& fds) const {
  device_.watch(fds);
}

std::string EmergencyStop::fault() const {
  if (!open_) return device_.fault();
  if (error_ != 0)
    return "the emergency stop at line " + line_ + " cannot be read (" + std::strerror(error_) +
           "): the motors are off";
  return "the emergency stop is pressed, or its wire at line " + line_ + " is broken: the motors are off";
}

}  // namespace cerberus::drivers
