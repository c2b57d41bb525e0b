// SPDX-License-Identifier: LGPL-2.1-or-later
// Publishes the base's yaw rate that a gyro measures (property base-gyro) as the upstream event `cerberus-base`. The
// gyro's bias is learnt while the robot stands (control/gyro_bias.h).
#pragma once

#include <gst/base/gstbasesink.h>

#include <mutex>
#include <string>

#include "control/gyro_bias.h"
#include "drivers/iio/gyro_runner.h"

namespace cerberus::plugin {

class BaseGyro {
 public:
  // which: as drivers::parse_gyro(); empty: no gyro. False: an error was posted. One that cannot be opened is an error
  // later.
  bool start(GstBaseSink* sink, const std::string& which);
  void stop();
  // A frame that was taken at `taken` (running time), with the motion of its picture where that was measured.
  void on_frame(GstBuffer* buffer, std::optional<control::PictureMotion> motion, const vision::Lens& lens,
                motion::Time taken);
  // An event that the application sends: the base's rate by its own word.
  void on_event(GstEvent* event);

 private:
  void publish(double measured);

  GstBaseSink* sink_ = nullptr;  // while there is a gyro
  std::mutex lock_;              // bias_
  control::GyroBias bias_;
  drivers::GyroRunner runner_;
};

}  // namespace cerberus::plugin
