// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors of a program or a microcontroller, which sends a line at each change (sensor_lines.h): the standard output of
// a command, a serial port, or a FIFO. Lines are stamped when they are read. A sender that ends, vanishes or is silent
// is an outage. A command that has ended is started again, and a device that has vanished is opened again, once a second.
#pragma once

#include <vector>

#include "drivers/external/sensor_lines.h"
#include "drivers/helper/helper_process.h"
#include "drivers/sensor/sensor.h"
#include "drivers/transport/byte_stream.h"
#include "drivers/transport/line_buffer.h"

namespace cerberus::drivers {

class ExternalSensor final : public Sensor {
 public:
  // setup.options: "baud=N" of a serial port (115200), "silence=SECONDS" after which a sender that sends no line counts
  // as failed (3; 0 = never), "volts" (the sender sends volts, and these can be taken downstream).
  SensorError check(const SensorSetup& setup) const override;
  SensorError open(const SensorSetup& setup) override;
  ~ExternalSensor() override { close(); }
  void close() noexcept override;
  void stop() noexcept override {}
  int fd() const override;
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  std::string place(int sensor) const override;
  bool measures() const override { return options_.measures; }
  std::string outage() const override { return outage_; }

  static constexpr std::chrono::milliseconds kReopen{1000};
  static constexpr std::chrono::seconds kSilence{3};

 private:
  struct Options {
    int baud = 115200;
    Time silence = kSilence;
    bool measures = false;
  };
  static SensorError read_options(const std::string& text, Options& into);
  SensorError connect();
  void disconnect() noexcept;
  SensorError take(Time now, std::vector<SensorEdge>& edges);
  SensorError on_line(const SensorLine& line, Time now, std::vector<SensorEdge>& edges);
  void on_levels(const SensorLevels& levels, Time now, std::vector<SensorEdge>& edges);
  void forget_levels(Time now, bool restarts, std::vector<SensorEdge>& edges);
  void lose(Time now, std::string why, std::vector<SensorEdge>& edges);
  std::string described(const std::string& why) const;

  std::string command_, device_, name_;  // name_: for messages
  int sensors_ = 0;
  Options options_;
  HelperProcess process_;
  ByteStream serial_;
  int fifo_ = -1;
  LineBuffer lines_;
  std::vector<sensing::LevelSwitch> switches_;
  bool open_ = false;
  bool known_ = false;         // the levels of some sensor
  bool accepted_ = false;      // levels of all sensors have come since open()
  bool garbled_ = false;       // bytes have come since the last line of the protocol
  std::optional<Time> heard_;  // when the last line came, or reading began
  Time tried_{};               // to connect again
  std::string outage_;
};

}  // namespace cerberus::drivers
