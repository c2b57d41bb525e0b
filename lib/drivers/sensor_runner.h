// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors whose driver may block, on a thread of their own: whoever reads them takes what is there, and never waits. (Heads
// have a head_runner.h.)
//
// A driver that blocks for ever keeps its thread and its device until it returns, then closes and ends by itself; the
// runner may be long gone.
#pragma once

#include <thread>

#include "drivers/sensor.h"

namespace cerberus::drivers {

class SensorRunner final : public Sensor {
 public:
  // Takes open sensors, so many, and reads them for the first time, here and now. Error: they cannot be read in that way.
  SensorError take(std::unique_ptr<Sensor> sensor, int count);
  ~SensorRunner() override { close(); }

  SensorError open(const SensorSetup&) override { return {}; }
  // Gives the driver 80 ms to end.
  void close() noexcept override;
  void stop() noexcept override { close(); }
  int fd() const override;
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  std::string place(int sensor) const override { return places_[static_cast<std::size_t>(sensor)]; }
  bool measures() const override { return measures_; }

 private:
  struct Core;
  std::shared_ptr<Core> core_;
  std::thread worker_;
  std::vector<std::string> places_;
  bool measures_ = false;
};

}  // namespace cerberus::drivers
