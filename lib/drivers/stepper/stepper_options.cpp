// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/stepper/stepper_options.h"

#include <algorithm>

#include "drivers/helper/option_words.h"
#include "sensing/angles.h"

namespace cerberus::drivers {
namespace {

using sensing::radians;

struct Parameters {
  // Of a 28BYJ-48: 88 degrees a second is where it stalls without load (its data sheet's pull-out rate).
  double coil_rate = 1000;
  // Of a thread in user space on a stock kernel: FACTS of the project, 1 to 2 kHz.
  double step_rate = 2000;
  double most_rate = 10000;   // steps a second
  double most_steps = 1e6;    // a turn
  double homing_speed = 10;   // degrees a second
  double most_backlash = 20;  // degrees
};
constexpr Parameters kParameters;

std::string wrong_number(const OptionWord& word, const char* what) {
  return word.key + "=" + word.value + ": " + what;
}

// Reads one word. Returns what is wrong; empty: nothing.
std::string read(const OptionWord& word, StepperAxisOptions& axis) {
  const auto number = number_of(word.value);
  const auto between = [&](double from, double to) { return number && *number >= from && *number <= to; };
  if (word.key == "lines") {
    axis.lines = split(word.value, ',');
    if (axis.lines.size() < 2 || axis.lines.size() > 4 || std::ranges::count(axis.lines, "") > 0)
      return wrong_number(word, "name four coils, or STEP,DIR or STEP,DIR,EN");
  } else if (word.key == "steps") {
    if (!between(1, kParameters.most_steps)) return wrong_number(word, "a number of steps, 1 to 1000000");
    axis.steps = *number;
  } else if (word.key == "max-rate") {
    if (!between(1, kParameters.most_rate)) return wrong_number(word, "steps a second, 1 to 10000");
    axis.max_rate = *number;
  } else if (word.key == "backlash") {
    if (!between(0, kParameters.most_backlash)) return wrong_number(word, "degrees, 0 to 20");
    axis.backlash = radians(*number);
  } else if (word.key == "homing-speed") {
    if (!between(0.1, 360)) return wrong_number(word, "degrees a second, 0.1 to 360");
    axis.homing_speed = radians(*number);
  } else if (word.key == "end-stop") {
    const auto parts = split(word.value, '@');
    const auto angle = number_of(parts.back());
    if (parts.size() != 2 || parts.front().empty() || !angle || *angle == 0)
      return wrong_number(word, "LINE@DEGREES, where the switch is pressed; not 0");
    axis.end_stop = parts.front();
    axis.home_at = radians(*angle);
  } else if (word.key == "hard-stop") {
    if (!number || *number == 0) return wrong_number(word, "degrees, where the stop is; not 0");
    axis.hard_stop = true;
    axis.home_at = radians(*number);
  } else if (word.key == "invert") {
    return flag(word, axis.invert);
  } else if (word.key == "enable-high") {
    return flag(word, axis.enable_high);
  } else if (word.key == "end-stop-low") {
    return flag(word, axis.end_stop_low);
  } else {
    return "\"" + word.key + "\" is no option of a stepper axis: lines, steps, max-rate, backlash, invert, " +
           "enable-high, end-stop, end-stop-low, hard-stop, homing-speed";
  }
  return {};
}

}  // namespace

std::string parse_stepper_axis(std::string_view text, StepperAxisOptions& axis) {
  axis = {};
  axis.homing_speed = radians(kParameters.homing_speed);
  for (const OptionWord& word : option_words(text))
    if (std::string wrong = read(word, axis); !wrong.empty()) return wrong;
  if (axis.lines.empty()) return "lines= is missing: name four coils, or STEP,DIR or STEP,DIR,EN";
  const bool coils = axis.lines.size() == 4;
  if (axis.steps == 0 && !coils)
    return "steps= is missing: motor steps for one turn of the camera, microsteps and gears included";
  if (axis.steps == 0) axis.steps = kHalfSteps28byj48;
  if (axis.max_rate == 0) axis.max_rate = coils ? kParameters.coil_rate : kParameters.step_rate;
  if (axis.hard_stop && !axis.end_stop.empty()) return "end-stop and hard-stop exclude each other";
  return {};
}

std::string parse_release_delay(std::string_view text, std::optional<Time>& delay) {
  delay.reset();
  if (text == "never") return {};
  const auto seconds = number_of(text);
  if (!seconds || *seconds < 0 || *seconds > 86400)
    return "release-delay=" + std::string(text) + ": seconds, 0 to 86400, or \"never\"";
  delay = Time(static_cast<Time::rep>(*seconds * 1e9));
  return {};
}

}  // namespace cerberus::drivers
