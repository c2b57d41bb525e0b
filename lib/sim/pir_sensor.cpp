// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/pir_sensor.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {

PirSensor::Sight PirSensor::sight_of(const Warmth& thing) const {
  Sight sight;
  sight.there = thing.width > 0;
  sight.off = sensing::wrap(thing.bearing - bearing_);
  const double share = sight.off / traits_.field + .5;  // of the field, from its left edge
  if (sight.there && share >= 0 && share < 1) sight.zone = static_cast<int>(share * traits_.zones);
  return sight;
}

bool PirSensor::crosses(const Sight& before, const Sight& now, const Warmth& thing, double seconds) const {
  if (!before.there || !now.there || before.zone == now.zone || !(seconds > 0)) return false;
  const double zone = traits_.field / traits_.zones;
  const double hertz = std::abs(sensing::wrap(now.off - before.off)) / seconds / zone;
  const double passed = hertz / std::hypot(hertz, traits_.low) / std::hypot(1, hertz / traits_.high);
  return std::abs(thing.contrast) * std::min(1., thing.width / zone) * passed >= traits_.threshold;
}

void PirSensor::elapse(Time now, std::span<const Warmth> things) {
  const double t = motion::seconds(now), passed = t - motion::seconds(now_);
  now_ = now;
  seen_.resize(things.size());
  for (std::size_t i = 0; i < things.size(); ++i) {
    const Sight sight = sight_of(things[i]);
    if (crosses(seen_[i], sight, things[i], passed) && !triggered_) triggered_ = t + traits_.response;
    seen_[i] = sight;
  }
  if (high_ && t >= until_) {
    high_ = false;
    blocked_until_ = until_ + traits_.block;
  }
  if (!triggered_ || t < *triggered_) return;
  triggered_.reset();
  if (!high_ && t < blocked_until_) return;
  high_ = true;
  until_ = t + traits_.hold;
}

}  // namespace cerberus::sim
