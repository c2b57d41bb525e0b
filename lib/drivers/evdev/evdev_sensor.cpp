// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/evdev/evdev_sensor.h"

#include <linux/input-event-codes.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "drivers/evdev/input_codes.h"

namespace cerberus::drivers {

namespace {

constexpr int kRepeated = 2;  // value of a key that is held down

SensorError denied(const std::string& path, int error) {
  return {SensorFault::denied,
          "No permission to read input device " + path +
              ": add the user to the group input and log in again, or let a udev rule allow it.",
          errno_text(error)};
}

}  // namespace

// Opens the device of this path or name.
SensorError EvdevSensor::find(const std::string& wanted) {
  if (wanted.starts_with('/')) {
    const int error = device_.open(wanted);
    if (error == 0) return {};
    if (error == EACCES || error == EPERM) return denied(wanted, error);
    if (error != ENOENT && error != ENODEV && error != ENXIO)
      return {SensorFault::not_found, wanted + " is no input device (" + std::strerror(error) + ").",
              errno_text(error)};
  }
  std::string list, closed;
  for (const std::string& path : input_devices()) {
    const int error = device_.open(path);
    if (error == EACCES || error == EPERM) closed = path;
    if (error != 0) continue;
    const std::string name = device_.name();
    if (name == wanted) return {};
    list.append(list.empty() ? "" : ", ").append(path).append(" (").append(name).append(")");
  }
  device_.close();
  if (list.empty() && !closed.empty()) return denied(closed, EACCES);
  return {SensorFault::not_found,
          "There is no input device \"" + wanted + "\". " +
              (list.empty() ? "This machine has none at all." : "There are: " + list + "."),
          closed.empty() ? "" : "without permission to read " + closed};
}

SensorError EvdevSensor::check_codes() const {
  const std::vector<InputCode> there = device_.codes();
  for (const InputCode& code : codes_)
    if (std::ranges::find(there, code) == there.end())
      return {SensorFault::not_found,
              "Input device " + wanted_ + " (" + name_ + ") has no " + input_code_name(code) +
                  ". It has: " + input_code_list(there) + ".",
              ""};
  return {};
}

SensorError EvdevSensor::check(const SensorSetup& setup) const {
  if (setup.codes.size() != static_cast<std::size_t>(setup.sensors))
    return {SensorFault::settings,
            "Name one key or switch for each of the " + std::to_string(setup.sensors) + " sensors (codes); " +
                std::to_string(setup.codes.size()) + " are named.",
            ""};
  std::vector<InputCode> codes;
  for (const std::string& word : setup.codes) {
    const auto code = parse_input_code(word);
    if (!code)
      return {SensorFault::settings,
              "\"" + word + "\" is no key or switch: write key:30, switch:11 or a name as BTN_0 (codes).",
              ""};
    if (std::ranges::find(codes, *code) != codes.end())
      return {SensorFault::settings, "The key or switch " + word + " is named twice (codes).", ""};
    codes.push_back(*code);
  }
  return {};
}

SensorError EvdevSensor::open(const SensorSetup& setup) {
  close();
  if (SensorError error = check(setup)) return error;
  codes_.clear();
  for (const std::string& word : setup.codes) codes_.push_back(*parse_input_code(word));
  wanted_ = setup.device;
  SensorError error = find(wanted_);
  if (!error) {
    name_ = device_.name();
    error = check_codes();
  }
  if (error) {
    close();
    return error;
  }
  open_ = read_levels_ = true;
  levels_.assign(codes_.size(), false);
  return {};
}

void EvdevSensor::close() noexcept {
  device_.close();
  open_ = read_levels_ = dropped_ = false;
  outage_.clear();
}

bool EvdevSensor::reopen(Time now) {
  if (now - tried_ < kReopen) return false;
  tried_ = now;
  // Another device may have got the path meanwhile.
  if (find(wanted_) || device_.name() != name_ || check_codes())
    if (find(name_) || check_codes()) {
      device_.close();
      return false;
    }
  outage_.clear();
  dropped_ = false;
  read_levels_ = true;
  return true;
}

// Reports the levels that the device has now: all of them after opening, else those that differ.
void EvdevSensor::report_levels(Time now, std::vector<SensorEdge>& edges) {
  for (std::size_t i = 0; i < codes_.size(); ++i) {
    if (!read_levels_ && found_[i] == levels_[i]) continue;
    levels_[i] = found_[i];
    edges.push_back({.time = now, .sensor = static_cast<int>(i), .level = found_[i]});
  }
  read_levels_ = false;
}

void EvdevSensor::lose(Time now, int error, std::vector<SensorEdge>& edges) {
  device_.close();
  tried_ = now;
  outage_ = "Input device " + wanted_ + " (" + name_ + ") is gone (" + std::strerror(error) +
            "); it is used again when it returns";
  for (std::size_t i = 0; i < codes_.size(); ++i)
    edges.push_back({.time = now, .sensor = static_cast<int>(i), .known = false, .restarts = true});
}

SensorError EvdevSensor::read(Time now, std::vector<SensorEdge>& edges) {
  if (!open_) return {SensorFault::gone, "The input device is not open.", ""};
  if (device_.fd() < 0 && !reopen(now)) return {};
  bool resync = read_levels_;
  if (resync) {
    // Events before this moment are contained in the levels.
    if (const int error = device_.levels(codes_, found_)) return lose(now, error, edges), SensorError{};
    report_levels(now, edges);
  }
  events_.clear();
  const int error = device_.read(events_);
  resync = false;
  for (const InputEvent& event : events_) {
    if (event.code == InputCode{EV_SYN, SYN_DROPPED}) dropped_ = true;
    if (event.code == InputCode{EV_SYN, SYN_REPORT}) resync = std::exchange(dropped_, false) || resync;
    const auto found = std::ranges::find(codes_, event.code);
    if (dropped_ || found == codes_.end() || event.value == kRepeated) continue;
    const auto i = static_cast<std::size_t>(found - codes_.begin());
    if (levels_[i] == (event.value != 0)) continue;
    levels_[i] = event.value != 0;
    edges.push_back({.time = event.time, .sensor = static_cast<int>(i), .level = levels_[i]});
  }
  if (error != 0) return lose(now, error, edges), SensorError{};
  if (!resync) return {};
  if (const int failed = device_.levels(codes_, found_)) return lose(now, failed, edges), SensorError{};
  report_levels(now, edges);
  return {};
}

std::string EvdevSensor::place(int sensor) const {
  const auto i = static_cast<std::size_t>(sensor);
  return i < codes_.size() ? input_code_name(codes_[i]) + " of " + wanted_ : "input device";
}

}  // namespace cerberus::drivers
