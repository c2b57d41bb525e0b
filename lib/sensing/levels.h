// SPDX-License-Identifier: LGPL-2.1-or-later
// PIR sensors that tell volts instead of yes or no: a threshold makes a line's level of them, and a PirModel, as of any
// line, makes presence of that.
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

// A voltage as a line's level. Between the two edges it stays, and NaN changes nothing.
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
  // Begins (again): nothing is known of any sensor.
  void begin(std::size_t sensors, const LevelOptions& levels, const PirOptions& options = {});
  // What was measured at `time`, one number of volts a sensor; one that is missing or no number makes the sensor's
  // reading invalid. What is due before should have been asked for first: poll(deadline()).
  void measure(Time time, std::span<const float> volts);
  // Lets time pass; deadline(): when something changes next if nothing is measured, or kNever.
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
