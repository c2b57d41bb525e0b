// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors of one driver, each with its PirModel: a reading of all of them at the start, at every change and every
// heartbeat, with its time.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/sensor/sensor.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

struct SensorReading {
  Time time{};  // on the driver's clock, never going back
  std::array<sensing::Presence, sensing::kMaxSensors> presence{};
  std::array<float, sensing::kMaxSensors> volts{};  // of the newest samples; NaN: there is none
  sensing::SensorBits doubtful = 0;                 // detections that the robot's own motion may have caused
  sensing::SensorBits faulty = 0;                   // sensors whose fault() changed with this reading
  bool changed = false;  // presence or doubtful differ from the last reading; true for the first one
};

class SensorRunner;

// One thread at a time. Steady state allocates nothing.
class SensorArray {
 public:
  enum class Step : std::uint8_t {
    reading,  // here is one
    wait,     // nothing more until `now`: come again at due(), or when the driver's fd has something
    ended,    // of a recording
    failed,   // see error(); final. The reading before it is invalid: the sensors' states are unknown
  };

  SensorArray();
  ~SensorArray();

  // Takes the sensors and opens them, and waits for that for `patience` at most. heartbeat > 0. refused: called on
  // another thread if they cannot be opened, however late; must not block, nor call the array.
  SensorError open(std::unique_ptr<Sensor> sensor, const SensorSetup& setup,
                   const sensing::PirOptions& options, Time heartbeat,
                   Patience patience = std::chrono::minutes(10), std::function<void()> refused = {});
  void close() noexcept;
  // False: they are still being opened. Until then next() gives invalid readings; fd() becomes readable at the end.
  bool opened();

  // The next reading not later than `now`. Readings begin with the time of the first call; there is one at least.
  Step next(Time now, SensorReading& reading);
  // Of a recording: the next reading is that of `start`, of which
  // everything before it is known as if it had been played.
  void seek(Time start);
  // Of drivers that measure: a reading for each sample, whatever changes; false at the begin.
  void report_samples(bool all) { report_samples_ = all; }
  bool measures() const { return sensor_ && sensor_->measures(); }  // false before they are open
  // When next() has something at the latest. A recording may be played by this alone: next(due()).
  Time due() const;
  // Also why they could not be opened.
  SensorError error() const;
  // The base moves so from `time` on; geometry: of the sensors.
  void base(Time time, const sensing::Geometry& geometry, const sensing::BodyMotion& motion);

  int count() const { return static_cast<int>(models_.size()); }
  sensing::PirFault fault(int sensor) const { return models_[static_cast<std::size_t>(sensor)].fault(); }
  std::string place(int sensor) const { return sensor_ ? sensor_->place(sensor) : std::string(); }
  // The sensors' outage (Sensor::outage()) if it changed since the last call: a sentence without its point, or empty
  // for an end.
  std::optional<std::string> outage_change();
  int fd() const;
  bool recorded() const { return recorded_; }

 private:
  void begin(std::unique_ptr<Sensor> sensor);
  Time deadline() const;
  void let_pass(Time until);
  void begin_again(sensing::PirModel& model, bool restarts) const;
  bool look(Time time, SensorReading& reading);
  Step fail(SensorError error, Time now, SensorReading& reading);

  std::unique_ptr<SensorRunner> opening_;
  std::unique_ptr<Sensor> sensor_;  // open
  bool recorded_ = false;
  Time start_{};  // of a recording, by seek()
  sensing::PirOptions options_;
  std::vector<sensing::PirModel> models_;
  std::vector<SensorEdge> edges_;  // read; from next_edge_ on not yet passed to the models
  std::size_t next_edge_ = 0;
  std::vector<sensing::PirFault> faults_;
  SensorReading last_;
  std::array<float, sensing::kMaxSensors> volts_{};
  bool report_samples_ = false, sampled_ = false;  // sampled_: since the last reading
  SensorError error_;
  std::string outage_;  // as outage_change() returned it
  Time heartbeat_{}, beat_{}, end_{};
  bool begun_ = false;
};

}  // namespace cerberus::drivers
