// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors on lines of a GPIO chip, with the kernel's time stamps; edges are not polled. LEDs on output lines of the
// same chip. read() also reads the lines' levels, so that a sensor recovers from an edge that the kernel dropped, and a
// removed chip is detected although kernels before 6.5 do not wake a poll on it.
#pragma once

#include "drivers/gpio/gpio_lines.h"
#include "drivers/sensor/sensor.h"

namespace cerberus::drivers {

class GpioSensor final : public Sensor {
 public:
  ~GpioSensor() override { close(); }
  SensorError check(const SensorSetup& setup) const override;
  SensorError open(const SensorSetup& setup) override;
  void close() noexcept override;
  void stop() noexcept override;
  int fd() const override { return lines_.fd(); }
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  SensorError show(std::span<const sensing::Presence> readings) override;
  std::string place(int sensor) const override;

 private:
  SensorError request(const SensorSetup& setup);
  SensorError gone(int error) const;
  void begin(Time now, std::vector<SensorEdge>& edges);
  SensorError take(std::vector<SensorEdge>& edges, Time now);

  GpioLines lines_;
  std::string chip_;  // as named in messages
  std::vector<unsigned> inputs_, outputs_;
  std::size_t reds_ = 0, blues_ = 0;
  std::vector<GpioEdge> waiting_;
  std::vector<bool> levels_, asked_, leds_;  // as reported, as read from the chip, as lit
  bool open_ = false, begun_ = false;
};

}  // namespace cerberus::drivers
