// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/servo/servo_options.h"

#include <algorithm>
#include <cmath>

#include "drivers/helper/option_words.h"

namespace cerberus::drivers {
namespace {

using sensing::radians;

constexpr double kLeastPulse = 100, kMostPulse = 10000;  // microseconds; no servo takes others
constexpr double kUsualReach = 45;                       // degrees to each side at 1 and 2 ms
constexpr double kMostDegrees = 3600;

// "A,B" as two numbers, A below B.
bool pair_of(const std::string& text, double least, double most, double& a, double& b) {
  const auto parts = split(text, ',');
  if (parts.size() != 2) return false;
  const auto first = number_of(parts[0]), second = number_of(parts[1]);
  if (!first || !second || *first < least || *second > most || *first >= *second) return false;
  a = *first;
  b = *second;
  return true;
}

std::string read(const OptionWord& word, ServoAxisOptions& axis) {
  const std::string start = word.key + "=" + word.value + ": ";
  const auto number = number_of(word.value);
  double a = 0, b = 0;
  if (word.key == "channel") {
    if (!number || *number < 0 || *number > 255 || *number != std::floor(*number))
      return start + "a channel of the PWM chip, 0 to 255";
    axis.channel = static_cast<int>(*number);
  } else if (word.key == "pulse") {
    if (!pair_of(word.value, kLeastPulse, kMostPulse, a, b))
      return start + "SHORTEST,LONGEST in microseconds, 100 to 10000";
    axis.shortest = Time(std::llround(a * 1e3));
    axis.longest = Time(std::llround(b * 1e3));
  } else if (word.key == "range") {
    if (!pair_of(word.value, -kMostDegrees, kMostDegrees, a, b))
      return start + "FROM,TO in degrees at the shortest and the longest pulse";
    axis.from = radians(a);
    axis.to = radians(b);
  } else if (word.key == "trim") {
    if (!number || std::abs(*number) > 180) return start + "degrees, -180 to 180";
    axis.trim = radians(*number);
  } else if (word.key == "slew") {
    if (!number || *number <= 0 || *number > kMostDegrees) return start + "degrees a second, more than 0";
    axis.slew = radians(*number);
  } else if (word.key == "invert") {
    return flag(word, axis.invert);
  } else {
    return "\"" + word.key + "\" is no option of a servo axis: channel, pulse, range, trim, slew, invert";
  }
  return {};
}

}  // namespace

Time ServoAxisOptions::pulse_at(double angle) const {
  double share = (angle + trim - from) / (to - from);
  if (!std::isfinite(share)) share = 0.5;
  share = std::clamp(share, 0.0, 1.0);
  if (invert) share = 1 - share;
  return shortest + Time(std::llround(share * static_cast<double>((longest - shortest).count())));
}

motion::AxisLimits ServoAxisOptions::reach() const {
  motion::AxisLimits limits;
  limits.from = from - trim;
  limits.to = to - trim;
  return limits;
}

std::string ServoAxisOptions::beyond_reach(const std::string& name, const motion::AxisLimits& limits) const {
  const motion::AxisLimits most = reach();
  return channel < 0
             ? ""
             : motion::beyond_reach(name, limits, most.from, most.to, "the servo", " (range and trim)");
}

std::string parse_servo_axis(std::string_view text, ServoAxisOptions& axis) {
  axis = {};
  axis.from = radians(-kUsualReach);
  axis.to = radians(kUsualReach);
  for (const OptionWord& word : option_words(text))
    if (std::string wrong = read(word, axis); !wrong.empty()) return wrong;
  return axis.channel < 0 ? "channel= is missing: the servo's channel of the PWM chip" : "";
}

std::string pwm_chip_folder(const std::string& device) {
  if (device.find('/') != device.npos) return device;
  return "/sys/class/pwm/" + std::string(device.starts_with("pwmchip") ? "" : "pwmchip") + device;
}

}  // namespace cerberus::drivers
