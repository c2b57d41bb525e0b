// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/pir_sensor.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {
namespace {

// Of a signal of this frequency: the amplifier's band.
double passed(const PirTraits& traits, double hertz) {
  return hertz / std::hypot(hertz, traits.low) / std::hypot(1, hertz / traits.high);
}

}  // namespace

PirSensor::Sight PirSensor::sight_of(const Warmth& thing) const {
  Sight sight;
  sight.there = thing.width > 0 && std::ranges::any_of(traits_.reach, [&](const PirReach& reach) {
                  return thing.distance <= reach.distance && thing.low < reach.below;
                });
  sight.off = sensing::wrap(thing.bearing - bearing_);
  const double share = sight.off / traits_.field + .5;  // of the field, from its left edge
  if (sight.there && share >= 0 && share < 1) sight.zone = static_cast<int>(share * traits_.zones);
  return sight;
}

double threshold_for(const PirTraits& traits, double range) {
  constexpr double kSpeed = 1;
  const double zone = traits.field / traits.zones, width = 2 * std::atan(kPersonWidth / 2 / range);
  return kPersonContrast * std::min(1., width / zone) * passed(traits, kSpeed / range / zone);
}

PirTraits pir_traits(const sensing::PirPreset* module, double field, double range) {
  PirTraits traits;
  traits.zones = std::max(1, int(std::lround(traits.zones * field / traits.field)));
  traits.field = field;
  traits.reach[0].distance = range;
  traits.reach[1].distance = std::min(traits.reach[1].distance, range);
  traits.threshold = threshold_for(traits, range);
  const auto within = [](double seconds, const sensing::PirPreset::Span& span) {
    if (span.most == sensing::Time::zero()) return seconds;
    return std::clamp(seconds, motion::seconds(span.least), motion::seconds(span.most));
  };
  if (!module) return traits;
  traits.hold = within(traits.hold, module->module_hold);
  traits.block = within(traits.block, module->module_block);
  return traits;
}

bool PirSensor::crosses(const Sight& before, const Sight& now, const Warmth& thing, double seconds) const {
  if (!before.there || !now.there || before.zone == now.zone || !(seconds > 0)) return false;
  const double zone = traits_.field / traits_.zones;
  const double hertz = std::abs(sensing::wrap(now.off - before.off)) / seconds / zone;
  return std::abs(thing.contrast) * std::min(1., thing.width / zone) * passed(traits_, hertz) >=
         traits_.threshold;
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
