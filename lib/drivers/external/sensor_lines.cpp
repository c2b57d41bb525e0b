// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/external/sensor_lines.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace cerberus::drivers {

namespace {

constexpr std::string_view kBlank = " \t";

// Takes the next word off the line; empty: there is none.
std::string_view next_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  const std::string_view word = line.substr(0, line.find_first_of(kBlank));
  line.remove_prefix(word.size());
  return word;
}

template <typename Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<SensorLine> parse_hello(std::string_view line) {
  const auto version = number_of<int>(next_word(line));
  if (!version || *version < 1) return std::nullopt;
  if (*version != kSensorProtocol) return SensorHello{*version, 0};
  const auto sensors = number_of<int>(next_word(line));
  if (!sensors || *sensors < 1 || *sensors > sensing::kMaxSensors) return std::nullopt;
  return SensorHello{*version, *sensors};  // further words are of a later version
}

std::optional<SensorLine> parse_levels(std::string_view line, bool measured) {
  SensorLevels found;
  found.measured = measured;
  found.volts.fill(std::numeric_limits<float>::quiet_NaN());
  for (std::string_view word = next_word(line); !word.empty(); word = next_word(line)) {
    if (found.count == sensing::kMaxSensors) return std::nullopt;
    const auto i = static_cast<std::size_t>(found.count++);
    if (word == "-") continue;
    if (measured) {
      const auto volts = number_of<float>(word);
      if (!volts || !(std::abs(*volts) <= kMostSensorVolts)) return std::nullopt;
      found.volts[i] = *volts;
    } else {
      if (word != "0" && word != "1") return std::nullopt;
      found.levels[i] = word == "1";
    }
  }
  if (found.count == 0) return std::nullopt;
  return found;
}

SensorFaultText fault_text(std::string_view line) {
  constexpr std::size_t kMost = 200;
  line.remove_prefix(std::min(line.find_first_not_of(kBlank), line.size()));
  std::string text(line.substr(0, kMost));
  std::ranges::replace_if(text, [](char c) { return c < ' ' || c > '~'; }, '?');
  return {text};
}

}  // namespace

std::optional<SensorLine> parse_sensor_line(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  const std::string_view word = next_word(line);
  if (word == "cerberus-pir") return parse_hello(line);
  if (word == "levels") return parse_levels(line, false);
  if (word == "volts") return parse_levels(line, true);
  if (word == "fault") return fault_text(line);
  return std::nullopt;
}

}  // namespace cerberus::drivers
