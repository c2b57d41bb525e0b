// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads a gyro on a thread of its own, because a reading may block as long as its bus does. A gyro that fails after it
// was open is opened again once a second.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "drivers/iio/iio_gyro.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

class GyroRunner {
 public:
  // Called on the thread, never after stop() has returned; must not stop the runner.
  struct Calls {
    // Radians a second, positive to the right, with the gyro's bias.
    std::function<void(double rate)> on_rate;
    // The gyro cannot be opened (`final`: nothing more will come), or fails later; a default error: it works again.
    std::function<void(const SensorError& error, bool final)> on_change;
  };

  GyroRunner() = default;
  ~GyroRunner() { stop(); }
  GyroRunner(const GyroRunner&) = delete;
  GyroRunner& operator=(const GyroRunner&) = delete;

  void start(const GyroSetup& setup, Calls calls);
  // Waits for a call in progress, and at most 30 ms for the thread; one that hangs in a reading ends by itself.
  void stop() noexcept;

  static constexpr std::chrono::milliseconds kReopen{1000};

 private:
  struct Core;
  std::shared_ptr<Core> core_;
  std::optional<Worker> worker_;
};

}  // namespace cerberus::drivers
