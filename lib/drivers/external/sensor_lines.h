// SPDX-License-Identifier: LGPL-2.1-or-later
// The line protocol of PIR sensors in a program or a microcontroller, version 1. A line is ASCII text with a line feed
// at its end (a carriage return before it is ignored) and at most kMostLine bytes; numbers have a point in every
// locale. docs/manual/sensor-protocol.md describes it for authors.
//
//   cerberus-pir 1 SENSORS     first, and again whenever the sender likes
//   levels L L L               of all sensors: 0, 1, or - where nothing is known
//   volts V V V                what was measured, of all sensors: a number, or -
//   fault TEXT                 nothing is known of any sensor until the next levels or volts
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "sensing/sectors.h"

namespace cerberus::drivers {

inline constexpr int kSensorProtocol = 1;
inline constexpr float kMostSensorVolts = 1000;  // either way, as in recordings

struct SensorHello {
  int version = 0;  // 1 or more
  int sensors = 0;  // 1 to sensing::kMaxSensors; of another version 0
};

struct SensorLevels {
  bool measured = false;  // volts, else levels
  int count = 0;          // 1 to sensing::kMaxSensors
  std::array<std::optional<bool>, sensing::kMaxSensors> levels{};
  std::array<float, sensing::kMaxSensors> volts{};  // NaN: not known
};

struct SensorFaultText {
  std::string text;  // printable ASCII, at most 200 bytes
};

using SensorLine = std::variant<SensorHello, SensorLevels, SensorFaultText>;

// One line without its line feed. Nothing: it is no line of this protocol (comments, what a boot loader prints), and is
// to be skipped.
std::optional<SensorLine> parse_sensor_line(std::string_view line);

}  // namespace cerberus::drivers
