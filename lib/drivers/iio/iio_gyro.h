// SPDX-License-Identifier: LGPL-2.1-or-later
// A gyro of Linux' IIO as a measure of how fast a robot turns, read through sysfs:
//
//   (in_anglvel_z_raw + in_anglvel_z_offset) x in_anglvel_z_scale = radians a second about the axis, counter-clockwise
//
// (Documentation/ABI/testing/sysfs-bus-iio). Scale and offset may be common to all axes (in_anglvel_scale), and are 1
// and 0 where they are absent. libiio would read the same files, but only below /sys.
#pragma once

#include <string>

#include "drivers/sensor/sensor_setup.h"

namespace cerberus::drivers {

struct GyroSetup {
  std::string device;                             // id (iio:device1), name (mpu6050) or folder
  char axis = 'z';                                // x, y or z: which axis of the device is vertical
  bool down = false;                              // that axis points down
  std::string folder = "/sys/bus/iio/devices";    // of all devices
  Time interval = std::chrono::milliseconds(20);  // between readings
};

// Reads "mpu6050", "iio:device1 axis=-y": the device, and which of its axes points up, z where none is named. Returns
// what is wrong with the text; empty: nothing.
std::string parse_gyro(const std::string& text, GyroSetup& setup);

class IioGyro {
 public:
  IioGyro() = default;
  ~IioGyro() { close(); }
  IioGyro(const IioGyro&) = delete;
  IioGyro& operator=(const IioGyro&) = delete;

  SensorError open(const GyroSetup& setup);
  void close() noexcept;
  bool is_open() const { return raw_ >= 0; }
  // Radians a second, positive to the right (clockwise from above), with the gyro's bias. May block as long as the bus
  // takes. After an error the gyro is closed.
  SensorError read(double& rate);

 private:
  SensorError find(const GyroSetup& setup, std::string& folder);
  SensorError gone(int error);

  int raw_ = -1;
  double scale_ = 1, offset_ = 0;  // scale_: to radians a second to the right
  std::string name_;               // for messages
};

}  // namespace cerberus::drivers
