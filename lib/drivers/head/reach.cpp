// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/reach.h"

#include <utility>
#include <vector>

#include "drivers/head/inverted_head.h"
#include "drivers/servo/servo_options.h"
#include "sensing/angles.h"

namespace cerberus::drivers {
namespace {

std::string beyond_servos(std::span<const OptionWord> options, const motion::Limits& limits) {
  for (const OptionWord& word : options) {
    ServoAxisOptions axis;
    if ((word.key != "pan" && word.key != "tilt") || !parse_servo_axis(word.value, axis).empty()) continue;
    const auto& wanted = word.key == "pan" ? limits.pan : limits.tilt;
    if (std::string wrong = axis.beyond_reach(word.key, wanted); !wrong.empty()) return wrong;
  }
  return {};
}

// The range is the camera's own, before it is inverted.
std::string beyond_range(std::span<const OptionWord> options, const motion::Limits& limits) {
  std::optional<motion::Limits> range;
  Inverted inverted;
  for (const OptionWord& word : options) {
    if (word.key == "range") range = parse_range(word.value);
    if (word.key == "invert" && !parse_inverted(word, inverted).empty()) return {};
  }
  if (!range) return {};
  const auto axis = [](const char* name, const motion::AxisLimits& wanted, const motion::AxisLimits& most,
                       bool turned) {
    return motion::beyond_reach(name, wanted, turned ? -most.to : most.from, turned ? -most.from : most.to,
                                "the camera", " (range)");
  };
  std::string wrong = axis("pan", limits.pan, range->pan, inverted.pan);
  return wrong.empty() ? axis("tilt", limits.tilt, range->tilt, inverted.tilt) : wrong;
}

}  // namespace

std::optional<motion::Limits> parse_range(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ',')) {
    const auto number = number_of(part);
    if (!number) return std::nullopt;
    numbers.push_back(sensing::radians(*number));
  }
  if (numbers.size() != 4 || numbers[0] >= numbers[1] || numbers[2] >= numbers[3]) return std::nullopt;
  motion::Limits range;
  range.pan.from = numbers[0], range.pan.to = numbers[1];
  range.tilt.from = numbers[2], range.tilt.to = numbers[3];
  return range;
}

std::string beyond_reach(const std::string& driver, std::span<const OptionWord> options,
                         const motion::Limits& limits) {
  if (driver == "servo-pwm") return beyond_servos(options, limits);
  return driver == "onvif" ? beyond_range(options, limits) : "";
}

}  // namespace cerberus::drivers
