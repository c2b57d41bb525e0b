// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/gpio/gpio_sensor.h"

#include <algorithm>

#include "drivers/gpio/gpio_chip.h"

namespace cerberus::drivers {

namespace {

using sensing::Presence;

}  // namespace

SensorError GpioSensor::request(const SensorSetup& setup) {
  if (SensorError error = line_offsets(lines_, chip_, setup.lines, {}, inputs_)) return error;
  std::vector<std::string> leds = setup.red;
  leds.insert(leds.end(), setup.blue.begin(), setup.blue.end());
  if (SensorError error = line_offsets(lines_, chip_, leds, inputs_, outputs_)) return error;
  if (const int error = lines_.request_inputs(inputs_, setup.bias))
    return lines_refused(lines_, chip_, error, inputs_);
  if (outputs_.empty()) return {};
  const int error = lines_.request_outputs(outputs_);
  return error ? lines_refused(lines_, chip_, error, outputs_) : SensorError{};
}

SensorError GpioSensor::check(const SensorSetup& setup) const {
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
  std::vector<std::string> all = setup.lines;
  all.insert(all.end(), setup.red.begin(), setup.red.end());
  all.insert(all.end(), setup.blue.begin(), setup.blue.end());
  if (std::find(all.begin(), all.end(), "") != all.end())
    return {SensorFault::settings,
            "A GPIO line without a name stands between two commas (lines, leds-red, leds-blue).", ""};
  for (auto one = all.begin(); one != all.end(); ++one)
    if (std::find(all.begin(), one, *one) != one)
      return {SensorFault::settings,
              "The GPIO line " + *one +
                  " is named twice: each sensor and each LED has its own (lines, leds-red, leds-blue).",
              ""};
  return {};
}

SensorError GpioSensor::open(const SensorSetup& setup) {
  close();
  if (SensorError error = check(setup)) return error;
  SensorError error = open_gpio_chip(lines_, setup.chip, chip_);
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
  return chip_gone(chip_, error);
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
