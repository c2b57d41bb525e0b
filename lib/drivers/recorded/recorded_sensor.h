// SPDX-License-Identifier: LGPL-2.1-or-later
// The common base of replay and scripted sensors, which plays a Recording.
#pragma once

#include <cstddef>

#include "drivers/recorded/recording.h"

namespace cerberus::drivers {

class RecordedSensor : public Sensor {
 public:
  void close() noexcept override;
  void stop() noexcept override {}
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  std::string place(int sensor) const override;
  bool measures() const override { return recording_.volts; }
  bool recorded() const override { return true; }
  Time next() const override;
  void rewind() override { next_ = 0; }
  Time end() const override { return recording_.end; }

 protected:
  void play(Recording recording, std::string name, const sensing::LevelOptions& level);

 private:
  Recording recording_;
  std::string name_;
  std::size_t next_ = 0;
};

}  // namespace cerberus::drivers
