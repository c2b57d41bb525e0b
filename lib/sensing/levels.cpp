// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/levels.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sensing {

void LevelSensors::begin(std::size_t sensors, const LevelOptions& levels, const PirOptions& options) {
  inputs_.assign(sensors, Input{LevelSwitch(levels), PirModel(options)});
  presence_.assign(sensors, Presence::invalid);
}

void LevelSensors::measure(Time time, std::span<const float> volts) {
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Input& input = inputs_[i];
    input.measured = i < volts.size() && std::isfinite(volts[i]);
    if (input.measured)
      input.model.edge(time, input.level.update(static_cast<double>(volts[i])));
    else
      input.model.poll(time);
  }
  look();
}

void LevelSensors::poll(Time time) {
  for (Input& input : inputs_) input.model.poll(time);
  look();
}

Time LevelSensors::deadline() const {
  Time due = kNever;
  for (const Input& input : inputs_) due = std::min(due, input.model.deadline());
  return due;
}

void LevelSensors::look() {
  for (std::size_t i = 0; i < inputs_.size(); ++i)
    presence_[i] = inputs_[i].measured ? inputs_[i].model.presence() : Presence::invalid;
}

}  // namespace cerberus::sensing
