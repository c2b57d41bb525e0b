// SPDX-License-Identifier: LGPL-2.1-or-later
// Plays sensors from a file (format: recording.h). The whole file is read and checked when it is opened.
#pragma once

#include "drivers/recorded/recorded_sensor.h"

namespace cerberus::drivers {

class ReplaySensor final : public RecordedSensor {
 public:
  SensorError open(const SensorSetup& setup) override;
};

}  // namespace cerberus::drivers
