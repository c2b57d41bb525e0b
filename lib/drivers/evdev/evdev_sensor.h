// SPDX-License-Identifier: LGPL-2.1-or-later
// PIR receivers that the kernel shows as an input device (gpio-keys, USB and radio receivers): a key or switch is a
// sensor's line. The levels at opening are read from the device, later ones are events with the kernel's time stamps;
// where the kernel dropped events (SYN_DROPPED) the levels are read anew. A device that vanishes is an outage: it is
// looked for once a second, by its path and then by its name.
#pragma once

#include "drivers/evdev/input_device.h"
#include "drivers/sensor/sensor.h"

namespace cerberus::drivers {

class EvdevSensor final : public Sensor {
 public:
  ~EvdevSensor() override { close(); }
  SensorError check(const SensorSetup& setup) const override;
  SensorError open(const SensorSetup& setup) override;
  void close() noexcept override;
  void stop() noexcept override {}
  int fd() const override { return device_.fd(); }
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  std::string place(int sensor) const override;
  std::string outage() const override { return outage_; }

  static constexpr std::chrono::milliseconds kReopen{1000};

 private:
  SensorError find(const std::string& wanted);
  SensorError check_codes() const;
  bool reopen(Time now);
  void report_levels(Time now, std::vector<SensorEdge>& edges);
  void lose(Time now, int error, std::vector<SensorEdge>& edges);

  InputDevice device_;
  std::string wanted_, name_;  // as the user named it, as the device names itself
  std::vector<InputCode> codes_;
  std::vector<InputEvent> events_;
  std::vector<bool> levels_, found_;  // as reported, as read
  bool open_ = false;
  bool read_levels_ = false;  // all of them, with the next read()
  bool dropped_ = false;      // events until the next SYN_REPORT are incomplete
  std::string outage_;
  Time tried_{};
};

}  // namespace cerberus::drivers
