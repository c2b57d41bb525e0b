// SPDX-License-Identifier: LGPL-2.1-or-later
// Options of the driver servo-pwm as a user writes them. An axis is one text of words:
//
//   channel=0              of the PWM chip
//   pulse=1000,2000        microseconds at the two ends of the range
//   range=-45,45           degrees at these pulses, left and right (down and up)
//   trim=2                 degrees that are added: the servo's horn sits on teeth
//   invert                 the servo turns the other way round
//   slew=60                degrees a second at most, where the servo is slower than max-speed
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "motion/head_limits.h"

namespace cerberus::drivers {

using motion::Time;

struct ServoAxisOptions {
  int channel = -1;  // -1: the head has no such axis
  Time shortest{1'000'000}, longest{2'000'000};
  double from = 0, to = 0;  // radians at the shortest and the longest pulse
  double trim = 0;          // radians
  bool invert = false;
  double slew = 0;  // radians a second; 0: not limited here

  // The pulse at which the servo looks along `angle` (radians), within shortest and longest.
  Time pulse_at(double angle) const;
  // The angles that it reaches, trim included.
  motion::AxisLimits reach() const;
  // What of the limits of the axis `name` it does not reach, for a user; empty: nothing.
  std::string beyond_reach(const std::string& name, const motion::AxisLimits& limits) const;
};

struct ServoOptions {
  std::string chip;  // its folder
  ServoAxisOptions pan, tilt;
  Time period{20'000'000};
  std::optional<Time> release_delay = std::chrono::seconds(3);  // nullopt: the pulses never end
};

// Reads the words of one axis. Returns what is wrong with them; empty: nothing.
std::string parse_servo_axis(std::string_view text, ServoAxisOptions& axis);
// "pwmchip0", "0" or a path -> a folder.
std::string pwm_chip_folder(const std::string& device);

}  // namespace cerberus::drivers
