// SPDX-License-Identifier: LGPL-2.1-or-later
// Checks settings against the sensors and the head that are present: a mismatch causes no failure, but the settings
// have no effect. Each finding is returned once, as a text for the user; empty: no mismatch, or it was returned before.
#pragma once

#include <chrono>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "fusion/sensor_snapshot.h"

namespace cerberus::fusion {

class SettingsCheck {
 public:
  // Compares the number of sensors with that of `rules` for `wanted` sensors (0: any number).
  std::string sensors(const std::string& rules, int wanted, const SensorSnapshot& snapshot) {
    const auto there = static_cast<int>(snapshot.count);
    if (wanted == 0 || there == 0 || there == wanted || !snapshot.geometry_known) return {};
    if (std::exchange(reported_, std::pair(wanted, there)) == std::pair(wanted, there)) return {};
    return rules + " is for " + std::to_string(wanted) + " PIR sensors, and there are " +
           std::to_string(there) + ": " +
           (there < wanted ? "the others never detect anything." : "the readings of the others are ignored.");
  }

  // Checks whether for 2 s poses were received only from another head than `head`.
  std::string head(const std::string& head, Time time, const SensorSnapshot& snapshot) {
    constexpr Time kPatience = std::chrono::seconds(2);
    if (!snapshot.other_head || !std::isnan(snapshot.pan_degrees)) {
      since_.reset();
      return {};
    }
    if (!since_ || time < *since_) since_ = time;
    if (time - *since_ < kPatience || std::exchange(head_reported_, true)) return {};
    return "Poses come from the head \"" + std::string(snapshot.other_head) + "\" and none from \"" + head +
           "\" (property head): pan is not known, and no turn is decided.";
  }

 private:
  std::pair<int, int> reported_{0, 0};
  std::optional<Time> since_;
  bool head_reported_ = false;
};

}  // namespace cerberus::fusion
