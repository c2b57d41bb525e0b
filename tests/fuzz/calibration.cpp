// SPDX-License-Identifier: LGPL-2.1-or-later
// The calibration file of a head. What is accepted is written and accepted again, and gives finite speeds.
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "drivers/head/head_calibration.h"

using namespace cerberus::drivers;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  HeadCalibration calibration;
  const std::string wrong = parse_calibration({reinterpret_cast<const char*>(data), size}, calibration);
  if (!wrong.empty()) return 0;
  for (const double speed : {-5.0, 0.0, 1e-6, 0.3, 1.0})
    if (!std::isfinite(calibration.pan.actual(speed)) || !std::isfinite(calibration.tilt.command_for(speed)))
      std::abort();
  calibrated_device(calibration.driver, calibration.device, calibration.device);
  return 0;
}
