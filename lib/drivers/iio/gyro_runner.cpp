// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/iio/gyro_runner.h"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace cerberus::drivers {

// Shared by owner and thread. The thread alone uses `gyro`.
struct GyroRunner::Core {
  GyroSetup setup;
  Calls calls;
  IioGyro gyro;
  std::mutex calling;  // held during a call; guards `silent`
  bool silent = false;
  std::mutex lock;  // of the next two
  std::condition_variable wake;
  bool quits = false;

  // False: the owner has stopped the runner.
  template <typename Call>
  bool call(Call make) {
    const std::lock_guard guard(calling);
    if (!silent) make();
    return !silent;
  }
  bool sleep(Time time) {
    std::unique_lock guard(lock);
    return !wake.wait_for(guard, time, [this] { return quits; });
  }
  void run();
};

void GyroRunner::Core::run() {
  if (const SensorError error = gyro.open(setup)) {
    call([&] { calls.on_change(error, true); });
    return;
  }
  for (bool works = true; sleep(works ? setup.interval : Time(kReopen));) {
    double rate = 0;
    const SensorError error = gyro.is_open() ? gyro.read(rate) : gyro.open(setup);
    const bool worked = std::exchange(works, !error);
    if (works != worked && !call([&] { calls.on_change(error, false); })) return;
    if (works && worked && !call([&] { calls.on_rate(rate); })) return;
  }
}

void GyroRunner::start(const GyroSetup& setup, Calls calls) {
  stop();
  core_ = std::make_shared<Core>();
  core_->setup = setup;
  core_->calls = std::move(calls);
  worker_.emplace([core = core_] { core->run(); });
}

void GyroRunner::stop() noexcept {
  if (!core_) return;
  {
    const std::lock_guard guard(core_->lock);
    core_->quits = true;
  }
  core_->wake.notify_all();
  {
    const std::lock_guard guard(core_->calling);
    core_->silent = true;
  }
  if (worker_) worker_->leave(std::chrono::milliseconds(30));
  worker_.reset();
  core_.reset();
}

}  // namespace cerberus::drivers
