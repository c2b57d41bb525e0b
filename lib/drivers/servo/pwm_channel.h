// SPDX-License-Identifier: LGPL-2.1-or-later
// One channel of a PWM chip through the kernel's sysfs interface: pulses of a given width every period. A board with a
// PCA9685 is such a chip, too. Functions that can fail return errno, 0 = no error.
#pragma once

#include <chrono>
#include <string>

#include "motion/head_limits.h"

namespace cerberus::drivers {

using motion::Time;

class PwmChannel {
 public:
  PwmChannel() = default;
  ~PwmChannel() { close(); }
  PwmChannel(const PwmChannel&) = delete;
  PwmChannel& operator=(const PwmChannel&) = delete;

  // chip: the chip's folder. Exports the channel if need be and sets its period; no pulse is given yet. Waits up to
  // `patience` for the rights that udev gives to a new channel. step: which file was refused. EALREADY: another program
  // drives the channel.
  int open(const std::string& chip, int channel, Time period, std::chrono::milliseconds patience,
           std::string& step);
  void close() noexcept;  // leaves the pulses as they are
  bool is_open() const { return duty_ >= 0; }
  // Width of the pulses, from the next period on; 0: none.
  int set_width(Time width) noexcept;
  int enable(bool on) noexcept;
  // Whether the channel that was opened is still there: ENODEV if not. Writes nothing.
  int probe() const noexcept;

  // derived: udev has changed the rights of a new channel by then
  static constexpr std::chrono::milliseconds kPatience{400};

 private:
  int duty_ = -1, enable_ = -1;  // descriptors
  std::string duty_path_;
};

}  // namespace cerberus::drivers
