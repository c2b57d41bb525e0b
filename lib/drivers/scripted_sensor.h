// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors for tests: a recording in one line, which may end in a failure.
//
//   script = line {";" line}
//   line   = SECONDS "," LEVEL {"," LEVEL}     as in recording.h: "0,0,0,0; 2.5,1,0,0", or volts: "0,0.1V,3V,0V"
//          | "open fail" TEXT                  opening fails
//          | SECONDS "fail" TEXT               from then on reading fails
//          | "show fail" TEXT                  the LEDs fail
#pragma once

#include "drivers/recorded_sensor.h"

namespace cerberus::drivers {

class ScriptedSensor final : public RecordedSensor {
 public:
  SensorError open(const SensorSetup& setup) override;
  void close() noexcept override;
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  SensorError show(std::span<const sensing::Presence> readings) override;
  Time next() const override;
  Time end() const override;

 private:
  Time fails_at_ = sensing::kNever;
  std::string failure_, led_failure_;
};

}  // namespace cerberus::drivers
