// SPDX-License-Identifier: LGPL-2.1-or-later
// Settings and errors of sensor drivers.
#pragma once

#include <chrono>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "sensing/levels.h"
#include "sensing/sectors.h"

namespace cerberus::drivers {

using sensing::Time;

enum class LineBias : std::uint8_t { as_is, none, pull_up, pull_down };

struct SensorSetup {
  int sensors = 3;  // 1 .. sensing::kMaxSensors

  // gpio: a path, a name (gpiochip0), a number or a label; lines by name or offset, one a sensor. Red and blue: LEDs,
  // one a sensor each, or none at all.
  std::string chip = "/dev/gpiochip0";
  std::vector<std::string> lines, red, blue;
  LineBias bias = LineBias::as_is;

  // evdev: path or name of the input device; keys and switches as in input_codes.h, one a sensor.
  // external: serial:/dev/ttyUSB0, or the path of a FIFO; or a command; options as in external_sensor.h.
  // iio: name (dummy) or id (iio:device0) of the converter, channel numbers, one a sensor.
  std::string device;
  std::vector<std::string> codes;
  std::string command, options;
  std::vector<std::string> channels;
  Time interval = std::chrono::milliseconds(10);  // between samples

  std::string location;  // replay: a file, see recording.h
  std::string script;    // scripted: see scripted_sensor.h

  sensing::LevelOptions level;  // of readings in volts: iio, recordings
};

enum class SensorFault : std::uint8_t {
  none,
  settings,   // the settings contradict each other or the device
  not_found,  // no such chip, line, device, channel, file
  busy,       // another process has it
  denied,     // no permission
  missing,    // this build has no such driver
  data,       // a recording that cannot be used
  gone,       // it was there and is no longer, or fails
};

struct SensorError {
  SensorFault fault = SensorFault::none;
  std::string text;    // for a user: names the device and the remedy
  std::string detail;  // for a developer
  explicit operator bool() const { return fault != SensorFault::none; }
};

// For a detail.
inline std::string errno_text(int error) {
  return "errno " + std::to_string(error) + ": " + std::strerror(error);
}

}  // namespace cerberus::drivers
