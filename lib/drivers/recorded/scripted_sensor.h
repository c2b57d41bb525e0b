// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors for tests: a recording in one line, which may end in a failure.
//
//   script = line {";" line}
//   line   = SECONDS "," LEVEL {"," LEVEL}     as in recording.h: "0,0,0,0; 2.5,1,0,0", or volts: "0,0.1V,3V,0V"
//          | "open wait" FD                    opening waits for something to read, or the end, at the descriptor
//          | "open fail" TEXT                  opening fails
//          | SECONDS "fail" TEXT               from then on reading fails
//          | "show fail" TEXT                  the LEDs fail
//          | "wait" FD FD                      not a recording but a device that blocks, for a live source: its first
//                                              read() returns the levels at 0 s; its second writes a byte
//                                              to the second descriptor, waits until the first is readable
//                                              or closed, and returns the rest
#pragma once

#include "drivers/recorded/recorded_sensor.h"

namespace cerberus::drivers {

class ScriptedSensor final : public RecordedSensor {
 public:
  SensorError open(const SensorSetup& setup) override;
  bool opens_at_once(const SensorSetup& setup) const override;
  void close() noexcept override;
  SensorError read(Time now, std::vector<SensorEdge>& edges) override;
  SensorError show(std::span<const sensing::Presence> readings) override;
  Time next() const override;
  Time end() const override;
  bool recorded() const override { return device_ < 0; }
  int fd() const override { return device_; }
  ~ScriptedSensor() override { close(); }

 private:
  bool parse_wait(std::string_view fds);
  void block();
  Time fails_at_ = sensing::kNever;
  std::string failure_, led_failure_;
  int gate_ = -1, bell_ = -1;  // descriptors to wait at, and to write to before
  int device_ = -1;            // readable until the second read()
  int reads_ = 0;              // of the device
};

}  // namespace cerberus::drivers
