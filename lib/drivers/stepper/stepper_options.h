// SPDX-License-Identifier: LGPL-2.1-or-later
// Options of the driver stepper-gpio as a user writes them. An axis is one text of words:
//
//   lines=17,18,27,22          four coils of a unipolar motor, or STEP,DIR or STEP,DIR,EN of a step driver
//   steps=4075.77              steps for one turn of the camera, gears included (4075.77: half steps of a 28BYJ-48)
//   max-rate=1000              steps a second that the motor follows at most
//   backlash=0.5               degrees of play between motor and camera
//   invert                     the motor turns the other way round
//   enable-high                EN switches on with 1, not with 0
//   end-stop=23@-100           a switch at line 23 that is pressed at -100 degrees
//   end-stop-low               the pressed switch pulls its line to 0 (normally open; else normally closed)
//   hard-stop=-100             home by running against a mechanical stop at -100 degrees
//   homing-speed=10            degrees a second
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "motion/head_limits.h"

namespace cerberus::drivers {

using motion::Time;

struct StepperAxisOptions {
  std::vector<std::string> lines;  // empty: the head has no such axis
  double steps = 0;                // a turn
  double max_rate = 0;             // steps a second
  double backlash = 0;             // radians
  bool invert = false, enable_high = false;
  std::string end_stop;  // its line; empty: none
  double home_at = 0;    // radians: where the end stop or the hard stop is
  bool end_stop_low = false;
  bool hard_stop = false;
  double homing_speed = 0;  // radians a second
};

struct StepperOptions {
  std::string chip;
  StepperAxisOptions pan, tilt;
  std::optional<Time> release_delay = std::chrono::seconds(1);  // nullopt: the motors stay on
  // A step that is later than this is refused. A head at 50 degrees a second is off its plan by one degree at 20 ms.
  Time stale = std::chrono::milliseconds(20);
};

// Of a 28BYJ-48: gears 32/9 x 22/11 x 26/9 x 31/10 and 64 half steps a turn of the rotor, 4075.7728.
inline constexpr double kHalfSteps28byj48 = 4075.7728395;

// Reads the words of one axis. Returns what is wrong with them; empty: nothing.
std::string parse_stepper_axis(std::string_view text, StepperAxisOptions& axis);
// "1.5" seconds or "never". Returns what is wrong; empty: nothing.
std::string parse_release_delay(std::string_view text, std::optional<Time>& delay);

}  // namespace cerberus::drivers
