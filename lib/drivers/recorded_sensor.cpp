// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/recorded_sensor.h"

#include <utility>

namespace cerberus::drivers {

void RecordedSensor::play(Recording recording, std::string name) {
  recording_ = std::move(recording);
  name_ = std::move(name);
  next_ = 0;
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
