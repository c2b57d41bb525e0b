// SPDX-License-Identifier: LGPL-2.1-or-later
// How fast the body turns, as events `cerberus-base` told: each holds until the next one's time, and no longer than
// CERBERUS_BASE_LIFETIME. Not thread-safe.
#pragma once

#include <cerberus/base.h>

#include <optional>

#include "sensing/pir_model.h"
#include "sensing/timeline.h"

namespace cerberus::plugin {

static_assert(sensing::kBaseLifetime == std::chrono::nanoseconds(CERBERUS_BASE_LIFETIME));

using Time = std::chrono::nanoseconds;
using sensing::Timeline;

class ToldBase {
 public:
  void hear(Time from, double degrees_a_second) { rates_.insert(from, degrees_a_second); }
  // Degrees a second; nothing: nobody told, or whoever did has fallen silent.
  std::optional<double> at(Time time) const {
    const auto* told = rates_.entry_at(time);
    if (!told || time - told->time >= sensing::kBaseLifetime) return std::nullopt;
    return told->value;
  }
  void forget_before(Time time) { rates_.forget_before(time); }
  void clear() { rates_.clear(); }

 private:
  Timeline<double> rates_;
};

}  // namespace cerberus::plugin
