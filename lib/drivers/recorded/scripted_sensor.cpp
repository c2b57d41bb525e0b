// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/recorded/scripted_sensor.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <utility>

#include "drivers/simulated/gate.h"

namespace cerberus::drivers {

namespace {

constexpr std::string_view kFail = "fail ";
constexpr std::string_view kWait = "wait ";
constexpr std::string_view kOpenWait = "open wait ";

std::string_view next_line(std::string_view& script) {
  const auto end = script.find(';');
  std::string_view line = script.substr(0, end);
  script.remove_prefix(end == script.npos ? script.size() : end + 1);
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  return line;
}

bool parse_fd(std::string_view text, int& fd) {
  return std::from_chars(text.data(), text.data() + text.size(), fd).ec == std::errc();
}

}  // namespace

bool ScriptedSensor::opens_at_once(const SensorSetup& setup) const {
  return setup.script.find(kWait) == std::string::npos;
}

SensorError ScriptedSensor::open(const SensorSetup& setup) {
  close();
  std::string levels;
  for (std::string_view script = setup.script; !script.empty();) {
    const std::string_view line = next_line(script);
    if (line.starts_with(kWait) && parse_wait(line.substr(kWait.size()))) {
      levels.append("\n");  // keeps the line numbers of errors
      continue;
    }
    int gate = -1;
    if (line.starts_with(kOpenWait) && parse_fd(line.substr(kOpenWait.size()), gate)) {
      wait_at(gate);
      levels.append("\n");
      continue;
    }
    const auto fail = line.find(kFail);
    if (fail == line.npos) {
      levels.append(line).append("\n");
      continue;
    }
    const std::string text(line.substr(fail + kFail.size()));
    const std::string_view what = line.substr(0, fail);
    if (what == "open ") return {SensorFault::gone, text, "script"};
    levels.append("\n");
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
  if (device_ >= 0) ::close(device_);
  gate_ = bell_ = device_ = -1;
  reads_ = 0;
}

bool ScriptedSensor::parse_wait(std::string_view fds) {
  const auto space = fds.find(' ');
  if (space == fds.npos || !parse_fd(fds.substr(0, space), gate_)) return false;
  if (!parse_fd(fds.substr(space + 1), bell_)) return false;
  device_ = ::eventfd(1, EFD_CLOEXEC);
  return device_ >= 0;
}

void ScriptedSensor::block() {
  eventfd_t ignored = 0;
  ::eventfd_read(device_, &ignored);
  while (::write(bell_, "!", 1) < 0 && errno == EINTR) {
  }
  wait_at(gate_);
}

SensorError ScriptedSensor::read(Time now, std::vector<SensorEdge>& edges) {
  if (!recorded()) {
    const std::size_t before = edges.size();
    const bool first = reads_++ == 0;
    if (reads_ == 2) block();
    RecordedSensor::read(first ? Time::zero() : sensing::kNever, edges);
    for (std::size_t i = before; i < edges.size(); ++i) edges[i].time = now;
    return {};
  }
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
