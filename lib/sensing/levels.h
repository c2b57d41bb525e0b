// SPDX-License-Identifier: LGPL-2.1-or-later
// PIR sensors with an analogue output: a threshold converts volts to a line's level, and a PirModel converts the level
// to presence as for any line.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sensing/pir_model.h"

namespace cerberus::sensing {

// A line is high from threshold + hysteresis / 2 volts, low again below threshold - hysteresis / 2.
struct LevelOptions {
  double threshold = 1.65, hysteresis = 0.3;  // volts; hysteresis < 0 counts as 0
};

// Converts a voltage to a line's level. The level does not change between the two edges, nor at NaN.
class LevelSwitch {
 public:
  explicit LevelSwitch(const LevelOptions& options = {})
      : on_(options.threshold + half(options)), off_(options.threshold - half(options)) {}
  bool update(double volts) {
    if (volts >= on_)
      high_ = true;
    else if (volts < off_)
      high_ = false;
    return high_;
  }

 private:
  static double half(const LevelOptions& options) {
    return options.hysteresis > 0 ? options.hysteresis / 2 : 0;
  }
  double on_, off_;
  bool high_ = false;
};

// All sensors of a stream of voltages. Time passes as in PirModel. Allocates in begin() only.
class LevelSensors {
 public:
  // Begins (again) with all sensors in their initial state.
  void begin(std::size_t sensors, const LevelOptions& levels, const PirOptions& options = {});
  // Processes the voltages measured at `time`, one number of volts a sensor; a missing or NaN value makes the sensor's
  // reading invalid. Call poll(deadline()) first for changes that are due before `time`.
  void measure(Time time, std::span<const float> volts);
  // Advances the time. deadline(): the time of the next change if nothing is measured, or kNever.
  void poll(Time time);
  Time deadline() const;

  std::span<const Presence> presence() const { return presence_; }
  PirFault fault(std::size_t sensor) const { return inputs_[sensor].model.fault(); }

 private:
  struct Input {
    LevelSwitch level;
    PirModel model;
    bool measured = false;
  };
  void look();

  std::vector<Input> inputs_;
  std::vector<Presence> presence_;
};

}  // namespace cerberus::sensing
