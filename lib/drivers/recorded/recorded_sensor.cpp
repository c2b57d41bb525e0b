// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/recorded/recorded_sensor.h"

#include <array>
#include <utility>

namespace cerberus::drivers {

void RecordedSensor::play(Recording recording, std::string name, const sensing::LevelOptions& level) {
  recording_ = std::move(recording);
  name_ = std::move(name);
  next_ = 0;
  if (!recording_.volts) return;
  std::array<sensing::LevelSwitch, sensing::kMaxSensors> switches;
  switches.fill(sensing::LevelSwitch(level));
  for (SensorEdge& edge : recording_.edges)
    edge.level = switches[static_cast<std::size_t>(edge.sensor)].update(static_cast<double>(edge.volts));
}

void RecordedSensor::close() noexcept {
  recording_ = {};
  next_ = 0;
}

SensorError RecordedSensor::read(Time now, std::vector<SensorEdge>& edges) {
  for (; next() <= now && next_ < recording_.edges.size(); ++next_) edges.push_back(recording_.edges[next_]);
  return {};
}

Time RecordedSensor::next() const {
  return next_ < recording_.edges.size() ? recording_.edges[next_].time : sensing::kNever;
}

std::string RecordedSensor::place(int sensor) const {
  return "reading " + std::to_string(sensor + 1) + " of " + name_;
}

}  // namespace cerberus::drivers
