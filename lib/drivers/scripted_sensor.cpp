// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/scripted_sensor.h"

#include <algorithm>
#include <utility>

namespace cerberus::drivers {

namespace {

constexpr std::string_view kFail = "fail ";

std::string_view next_line(std::string_view& script) {
  const auto end = script.find(';');
  std::string_view line = script.substr(0, end);
  script.remove_prefix(end == script.npos ? script.size() : end + 1);
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  return line;
}

}  // namespace

SensorError ScriptedSensor::open(const SensorSetup& setup) {
  close();
  std::string levels;
  for (std::string_view script = setup.script; !script.empty();) {
    const std::string_view line = next_line(script);
    const auto fail = line.find(kFail);
    if (fail == line.npos) {
      levels.append(line).append("\n");
      continue;
    }
    const std::string text(line.substr(fail + kFail.size()));
    const std::string_view what = line.substr(0, fail);
    if (what == "open ") return {SensorFault::gone, text, "script"};
    levels.append("\n");  // lines are counted
    if (what == "show ") {
      led_failure_ = text;
    } else if (!what.empty() && parse_seconds(what.substr(0, what.size() - 1), fails_at_)) {
      failure_ = text;
    } else {
      return {SensorFault::settings,
              "The script \"" + setup.script + "\" is wrong: \"" + std::string(line) + "\".", ""};
    }
  }
  Recording recording;
  if (SensorError error = parse_recording(levels, "script", setup.sensors, recording)) return error;
  play(std::move(recording), "script", setup.level);
  return {};
}

void ScriptedSensor::close() noexcept {
  RecordedSensor::close();
  fails_at_ = sensing::kNever;
  failure_.clear();
  led_failure_.clear();
}

SensorError ScriptedSensor::read(Time now, std::vector<SensorEdge>& edges) {
  if (now >= fails_at_) return {SensorFault::gone, failure_, "script"};
  return RecordedSensor::read(now, edges);
}

SensorError ScriptedSensor::show(std::span<const sensing::Presence>) {
  if (led_failure_.empty()) return {};
  return {SensorFault::gone, led_failure_, "script"};
}

Time ScriptedSensor::next() const {
  return std::min(RecordedSensor::next(), fails_at_);
}

Time ScriptedSensor::end() const {
  return fails_at_ == sensing::kNever ? RecordedSensor::end() : std::max(fails_at_, RecordedSensor::end());
}

}  // namespace cerberus::drivers
