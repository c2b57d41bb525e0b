// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors on a thread of their own: the caller takes the readings that are there and never waits for the driver, neither
// while it is opened nor when it reads or lights LEDs. A recording is only opened there, then handed over. (The same for
// heads: head_runner.h.)
//
// A driver that blocks for ever keeps its thread and its device until it returns, then closes and ends by itself; the
// runner may be long gone.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "drivers/sensor/sensor.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

class SensorRunner final : public Sensor {
 public:
  SensorRunner() = default;
  ~SensorRunner() override { close(); }

  // Begins to open the sensors. refused: called if they cannot be
  // opened, on the thread; must not block, nor call the runner.
  void begin(std::unique_ptr<Sensor> sensor, const SensorSetup& setup, std::function<void()> refused);
  // Opening has ended, well or not, within `patience`. Before that there is nothing to read; fd() becomes readable then.
  bool opened(Patience patience = {}) const;
  // Why opening or reading failed.
  SensorError error() const;
  // The opened sensor, if it is a recording; once.
  std::unique_ptr<Sensor> recording();

  SensorError open(const SensorSetup&) override { return error(); }
  // Gives the driver 30 ms to end.
  void close() noexcept override;
  void stop() noexcept override { close(); }
  int fd() const override;
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  SensorError show(std::span<const sensing::Presence> readings) override;
  std::string place(int sensor) const override;
  bool measures() const override;
  std::string outage() const override;

 private:
  struct Core;
  std::shared_ptr<Core> core_;
  std::optional<Worker> worker_;
};

}  // namespace cerberus::drivers
