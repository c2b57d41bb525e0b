// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/gpio/gpio_sensor.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>

namespace cerberus::drivers {

namespace {

using sensing::Presence;

bool number_of(const std::string& text, unsigned& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return !text.empty() && error == std::errc() && end == text.data() + text.size();
}

std::vector<std::string> chip_paths() {
  std::vector<std::string> paths;
  std::error_code ignored;
  for (std::filesystem::directory_iterator it("/dev", ignored), end; !ignored && it != end;
       it.increment(ignored))
    if (it->path().filename().string().starts_with("gpiochip")) paths.push_back(it->path().string());
  std::ranges::sort(paths);
  return paths;
}

// Converts a path, a name or a number to a path; empty: none of them.
std::string path_of(const std::string& wanted) {
  unsigned number = 0;
  if (wanted.starts_with('/')) return wanted;
  if (number_of(wanted, number)) return "/dev/gpiochip" + wanted;
  return wanted.starts_with("gpiochip") ? "/dev/" + wanted : "";
}

std::string available(const std::vector<std::string>& chips) {
  if (chips.empty()) return "This machine has no GPIO chip at all.";
  std::string list;
  for (const std::string& chip : chips) list.append(list.empty() ? "" : ", ").append(chip);
  return "There are: " + list + ".";
}

}  // namespace

SensorError GpioSensor::open_chip(const std::string& wanted) {
  const std::vector<std::string> chips = chip_paths();
  int error = ENOENT;
  if (const std::string path = path_of(wanted); !path.empty()) {
    chip_ = path;
    error = lines_.open(path);
  } else {
    chip_ = wanted;
    for (const std::string& chip : chips) {
      const int opened = lines_.open(chip);
      if (opened == 0 && lines_.label() == wanted) {
        chip_ = chip;
        return {};
      }
      if (opened == EACCES) error = EACCES;
    }
    lines_.close();
  }
  switch (error) {
    case 0:
      return {};
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return {SensorFault::not_found, "There is no GPIO chip \"" + wanted + "\". " + available(chips),
              errno_text(error)};
    case EACCES:
    case EPERM:
      return {SensorFault::denied,
              "No permission to use GPIO chip " + chip_ +
                  ": on Debian add the user to the group gpio, or let a udev rule allow it.",
              errno_text(error)};
    default:
      return {SensorFault::not_found,
              chip_ + " cannot be used as a GPIO chip (" + std::strerror(error) + "). " + available(chips),
              errno_text(error)};
  }
}

SensorError GpioSensor::offsets_of(const std::vector<std::string>& names,
                                   std::vector<unsigned>& offsets) const {
  for (const std::string& name : names) {
    unsigned offset = 0;
    // A name takes precedence, because it may consist of digits.
    if (const int found = lines_.find(name); found >= 0) {
      offset = static_cast<unsigned>(found);
    } else if (!number_of(name, offset)) {
      return {SensorFault::not_found,
              "GPIO chip " + chip_ + " has no line named \"" + name + "\"; gpioinfo lists its lines.", ""};
    } else if (offset >= lines_.count()) {
      return {SensorFault::not_found,
              "GPIO chip " + chip_ + " has no line " + name + ": its lines are 0 to " +
                  std::to_string(lines_.count() - 1) + ".",
              ""};
    }
    if (std::ranges::count(inputs_, offset) + std::ranges::count(offsets, offset) > 0)
      return {SensorFault::settings, "Line " + name + " of GPIO chip " + chip_ + " is named twice.", ""};
    offsets.push_back(offset);
  }
  return {};
}

// Returns the error for lines that the chip refuses. Releases all lines that it gave.
SensorError GpioSensor::refused(int error, std::span<const unsigned> offsets) {
  lines_.open(chip_);  // reopened: lines in use now have other consumers
  std::string list;
  for (const unsigned offset : offsets) {
    const std::string user = lines_.user(offset);
    if (error == EBUSY && !user.empty()) {
      return {SensorFault::busy,
              "Line " + std::to_string(offset) + " of GPIO chip " + chip_ + " is in use by \"" + user +
                  "\": end that, or take another line.",
              errno_text(error)};
    }
    list.append(list.empty() ? "" : ", ").append(std::to_string(offset));
  }
  if (error == EBUSY)
    return {SensorFault::busy,
            "Lines " + list + " of GPIO chip " + chip_ + " are not free: gpioinfo says who has them.",
            errno_text(error)};
  if (error == EACCES || error == EPERM)
    return {SensorFault::denied,
            "No permission to use lines " + list + " of GPIO chip " + chip_ + ": let a udev rule allow it.",
            errno_text(error)};
  return {SensorFault::gone,
          "GPIO chip " + chip_ + " does not give lines " + list + " (" + std::strerror(error) +
              "): perhaps it has no interrupts, or no such bias.",
          errno_text(error)};
}

SensorError GpioSensor::request(const SensorSetup& setup) {
  if (SensorError error = offsets_of(setup.lines, inputs_)) return error;
  std::vector<std::string> leds = setup.red;
  leds.insert(leds.end(), setup.blue.begin(), setup.blue.end());
  if (SensorError error = offsets_of(leds, outputs_)) return error;
  if (const int error = lines_.request_inputs(inputs_, setup.bias)) return refused(error, inputs_);
  if (outputs_.empty()) return {};
  const int error = lines_.request_outputs(outputs_);
  return error ? refused(error, outputs_) : SensorError{};
}

SensorError GpioSensor::open(const SensorSetup& setup) {
  close();
  const auto count = static_cast<std::size_t>(setup.sensors);
  if (setup.lines.size() != count)
    return {SensorFault::settings,
            "Name one GPIO line for each of the " + std::to_string(count) + " sensors (lines); " +
                std::to_string(setup.lines.size()) + " are named.",
            ""};
  for (const auto* leds : {&setup.red, &setup.blue})
    if (!leds->empty() && leds->size() != count)
      return {SensorFault::settings,
              "Name one LED of a colour for each of the " + std::to_string(count) + " sensors, or none.", ""};
  SensorError error = open_chip(setup.chip);
  if (!error) error = request(setup);
  if (!error)
    if (const int failed = lines_.levels(levels_)) error = gone(failed);
  if (error) {
    close();
    return error;
  }
  reds_ = setup.red.size();
  blues_ = setup.blue.size();
  leds_.assign(outputs_.size(), false);
  waiting_.reserve(1024);
  open_ = true;
  return {};
}

void GpioSensor::close() noexcept {
  stop();
  lines_.close();
  inputs_.clear();
  outputs_.clear();
  open_ = begun_ = false;
}

void GpioSensor::stop() noexcept {
  if (!open_ || leds_.empty()) return;
  std::fill(leds_.begin(), leds_.end(), false);
  lines_.set(leds_);  // an error is ignored: the LEDs of a removed chip cannot be changed
}

SensorError GpioSensor::gone(int error) const {
  return {
      SensorFault::gone,
      "GPIO chip " + chip_ + " does not answer any more (" + std::strerror(error) + "): was it unplugged?",
      errno_text(error)};
}

// Reports the levels that open() found, at a time not later than the first edge.
void GpioSensor::begin(Time now, std::vector<SensorEdge>& edges) {
  for (const GpioEdge& edge : waiting_) now = std::min(now, edge.time);
  for (std::size_t i = 0; i < levels_.size(); ++i) edges.push_back({now, static_cast<int>(i), levels_[i]});
  begun_ = true;
}

// Takes the edges that the kernel holds, in order of time.
SensorError GpioSensor::take(std::vector<SensorEdge>& edges, Time now) {
  waiting_.clear();
  if (const int error = lines_.read(waiting_)) return gone(error);
  std::ranges::stable_sort(waiting_, {}, &GpioEdge::time);
  if (!begun_) begin(now, edges);
  for (const GpioEdge& edge : waiting_) {
    levels_[edge.line] = edge.level;
    edges.push_back({edge.time, static_cast<int>(edge.line), edge.level});
  }
  return {};
}

SensorError GpioSensor::read(Time now, std::vector<SensorEdge>& edges) {
  if (!open_) return {SensorFault::gone, "The GPIO chip is not open.", ""};
  if (SensorError error = take(edges, now)) return error;
  if (const int error = lines_.levels(asked_)) return gone(error);
  if (!waiting_.empty() || asked_ == levels_) return {};
  // The levels differ without an edge: either an edge came after take(), or the kernel lost one.
  if (SensorError error = take(edges, now)) return error;
  if (!waiting_.empty()) return {};
  for (std::size_t i = 0; i < levels_.size(); ++i) {
    if (asked_[i] == levels_[i]) continue;
    levels_[i] = asked_[i];
    edges.push_back({now, static_cast<int>(i), asked_[i]});
  }
  return {};
}

SensorError GpioSensor::show(std::span<const Presence> readings) {
  if (leds_.empty()) return {};
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (i < reds_) leds_[i] = readings[i] == Presence::detected;
    if (i < blues_) leds_[reds_ + i] = readings[i] == Presence::none;
  }
  const int error = lines_.set(leds_);
  return error ? gone(error) : SensorError{};
}

std::string GpioSensor::place(int sensor) const {
  const auto i = static_cast<std::size_t>(sensor);
  return i < inputs_.size() ? "line " + std::to_string(inputs_[i]) + " of " + chip_ : "GPIO line";
}

}  // namespace cerberus::drivers
