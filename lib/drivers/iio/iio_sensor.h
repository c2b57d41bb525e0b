// SPDX-License-Identifier: LGPL-2.1-or-later
// Analogue sensors on an A/D converter of Linux' IIO: (in_voltageY_raw + offset) x scale = millivolts, compared with a
// threshold with hysteresis. Sampled at an interval by the timer behind fd(); every sample is reported.
#pragma once

#include "drivers/sensor/sensor.h"

struct iio_context;
struct iio_channel;

namespace cerberus::drivers {

class IioSensor final : public Sensor {
 public:
  ~IioSensor() override { close(); }
  SensorError check(const SensorSetup& setup) const override;
  SensorError open(const SensorSetup& setup) override;
  void close() noexcept override;
  void stop() noexcept override {}
  int fd() const override { return timer_; }
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  std::string place(int sensor) const override;
  bool measures() const override { return true; }

 private:
  struct Input {
    iio_channel* channel;
    double scale, offset;  // to millivolts
    sensing::LevelSwitch level;
  };
  SensorError find_channels(const SensorSetup& setup);
  SensorError gone(std::size_t input, int error) const;
  static int volts(const Input& input, double& volts);

  iio_context* context_ = nullptr;
  std::string device_;
  std::vector<Input> inputs_;
  int timer_ = -1;
  bool begun_ = false;
};

}  // namespace cerberus::drivers
