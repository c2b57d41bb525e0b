// SPDX-License-Identifier: LGPL-2.1-or-later
// The base's yaw rate, or its speed, as events report it: each value holds until the next one's time, and for
// kBaseLifetime at most.
// Not thread-safe.
#pragma once

#include <optional>

#include "sensing/own_motion.h"
#include "sensing/timeline.h"

namespace cerberus::sensing {

class BaseRates {
 public:
  using Time = std::chrono::nanoseconds;

  void add(Time from, double rate) { rates_.insert(from, rate); }
  // Nothing: no event was received, or the last one is too old.
  std::optional<double> at(Time time) const {
    const auto* rate = rates_.entry_at(time);
    if (!rate || time - rate->time >= kBaseLifetime) return std::nullopt;
    return rate->value;
  }
  void forget_before(Time time) { rates_.forget_before(time); }
  void clear() { rates_.clear(); }

 private:
  Timeline<double> rates_;
};

}  // namespace cerberus::sensing
