// SPDX-License-Identifier: LGPL-2.1-or-later
// A PIR module: its lens cuts the field of view into zones, and what is warmer or colder than its surroundings triggers
// it when it crosses a border of zones. That it moves or the module turns makes no difference. Radians, seconds, kelvin.
//
//   strength of a crossing = |contrast| min(1, width / zone) g(rate / zone), of what a reach of the module holds
//   g(f) = band pass of first order, low .. high Hz
//   output: high `response` after a crossing of at least `threshold`, for `hold` from the last one; then nothing
//   triggers for `block`
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "motion/head_limits.h"
#include "sensing/pir_model.h"

namespace cerberus::sim {

using motion::Time;

// As far as a module sees what begins below a height above the floor. Metres.
struct PirReach {
  double distance, below;
};
// Zones A and C of the paper's Figure 1.
inline constexpr std::array<PirReach, 2> kPaperReach{{{12, 1.5}, {3, 2.5}}};

// A person before a wall, as sensors see them: metres and kelvin.
inline constexpr double kPersonWidth = .48, kPersonContrast = 6;

struct PirTraits {
  double field = sensing::radians(110);
  int zones = 14;             // of about 8 degrees
  double threshold = 2;       // kelvin: a person of 6 K is found up to 10 m away
  double low = .3, high = 8;  // Hz, of the amplifier
  double response = .1;       // seconds
  double hold = 2.5;          // seconds, extended by each crossing
  double block = .2;          // seconds after the output fell
  std::array<PirReach, 2> reach = kPaperReach;
};

// Something as a sensor sees it. A sensor compares things of the same place in the list.
struct Warmth {
  double bearing = 0;            // from the body
  double width = 0;              // 0: it is not there
  double contrast = 0;           // kelvin
  double distance = 0, low = 0;  // metres: of its lower end above the floor
};

// A module that finds people up to `range` metres away, in segments of about 8 degrees. module: its hold and block times,
// where they are known; nullptr: none in particular.
PirTraits pir_traits(const sensing::PirPreset* module, double field, double range);
// The threshold with which a module just finds a person (.48 m, 6 K) who crosses at 1 m/s, `range` metres away.
double threshold_for(const PirTraits& traits, double range);

class PirSensor {
 public:
  // bearing: of the sensor's axis from the body.
  PirSensor(const PirTraits& traits, double bearing) : traits_(traits), bearing_(bearing) {}

  void elapse(Time now, std::span<const Warmth> things);
  bool output() const { return high_; }
  double bearing() const { return bearing_; }

 private:
  struct Sight {
    double off = 0;
    int zone = kOutside;
    bool there = false;
  };
  static constexpr int kOutside = -1;
  Sight sight_of(const Warmth& thing) const;
  bool crosses(const Sight& before, const Sight& now, const Warmth& thing, double seconds) const;

  PirTraits traits_;
  double bearing_;
  std::vector<Sight> seen_;
  Time now_{};
  std::optional<double> triggered_;  // seconds: a crossing whose response is still to come
  bool high_ = false;
  double until_ = 0, blocked_until_ = 0;  // seconds
};

}  // namespace cerberus::sim
