// SPDX-License-Identifier: LGPL-2.1-or-later
// What was measured of one head, and the file that holds it: text, one `key = value` a line, bound to its device
// (docs/manual/calibration.md).
//
//   cerberus-calibration = 1
//   driver = visca
//   device = serial:/dev/ttyUSB0
//   dead-time = 0.152                 seconds
//   pan-backlash = 0.3                degrees; tilt-backlash likewise
//   pan-speeds = 4:4.2 16:15.1        commanded:actual, degrees a second, rising; tilt-speeds likewise
//   stops-alone = 1.4                 seconds after which the head stopped when its helper was killed, or `no`
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "drivers/head/head.h"

namespace cerberus::drivers {

struct HeadCalibration {
  std::string driver, device;
  motion::Time dead_time{};
  double pan_backlash = 0, tilt_backlash = 0;  // radians
  motion::SpeedMap pan, tilt;
  std::optional<double> stops_alone;  // seconds; nothing: it goes on, or that was not tried
};

// The device of a head as a calibration names it: without a user's name and password, and of an external helper the
// program alone.
std::string calibrated_device(std::string_view driver, std::string_view device, std::string_view command);

// Returns what is wrong with the text, with the line's number; empty: `calibration` is set.
std::string parse_calibration(std::string_view text, HeadCalibration& calibration);
std::string calibration_text(const HeadCalibration& calibration);
// Reads the file. Returns what is wrong, naming the file; also if it was measured with another head.
std::string read_calibration(const std::string& path, const std::string& driver, const std::string& device,
                             HeadCalibration& calibration);

// Sets what `setup` knows of its head as the file has it. Returns what is wrong; nothing is changed then.
std::string use_calibration(const std::string& path, const std::string& driver, HeadSetup& setup);

}  // namespace cerberus::drivers
