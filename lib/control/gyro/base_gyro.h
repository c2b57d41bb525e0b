// SPDX-License-Identifier: LGPL-2.1-or-later
// A gyro on the body that carries the head: reads it on a thread of its own (drivers/iio/gyro_runner.h) and publishes
// the base's yaw rate as soon as its bias is known (gyro_bias.h). Thread-safe.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "control/gyro/gyro_bias.h"
#include "drivers/iio/gyro_runner.h"

namespace cerberus::control {

class BaseGyro {
 public:
  using Time = motion::Time;
  // Called on the gyro's thread, never after stop() has returned.
  struct Calls {
    std::function<std::optional<Time>()> now;             // running time; nothing: it does not run
    std::function<void(Time time, double rate)> on_rate;  // radians a second, positive to the right
    // As GyroRunner::Calls::on_change; the text for a user.
    std::function<void(const drivers::SensorError& error, bool final)> on_change;
  };

  // which: as drivers::parse_gyro(); empty: no gyro. Returns what is wrong with the text; empty: nothing.
  std::string start(const std::string& which, Calls calls);
  void stop() noexcept;
  // A frame that was taken at `taken`, with the motion of its picture where that was measured. look: of the head then;
  // rests: the head does.
  void frame(Time taken, std::optional<PictureMotion> motion, const vision::Lens& lens,
             const motion::PanTilt& look, bool rests);
  // The robot reports its rate, radians a second, from `time` on.
  void robot(Time time, double rate);

 private:
  void measured(double rate);

  Calls calls_;
  std::mutex lock_;  // bias_
  GyroBias bias_;
  drivers::GyroRunner runner_;
};

}  // namespace cerberus::control
