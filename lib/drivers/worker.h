// SPDX-License-Identifier: LGPL-2.1-or-later
// A thread for calls that may never return. A head has one (head_runner.h), and so have sensors (sensor_runner.h).
#pragma once

#include <chrono>
#include <functional>
#include <future>
#include <mutex>
#include <thread>
#include <utility>

namespace cerberus::drivers {

using Patience = std::chrono::steady_clock::duration;

class Worker {
 public:
  // `work` owns or shares all that it touches: if it hangs, it keeps that until it returns, beyond the life of the
  // Worker.
  template <typename Work>
  explicit Worker(Work work) {
    std::promise<void> over;
    over_ = over.get_future();
    thread_ = std::thread([work = std::move(work), over = std::move(over)]() mutable {
      work();
      over.set_value();
    });
  }
  ~Worker() { leave({}); }
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  // Waits for the end of the work for `patience`; then detaches it.
  void leave(Patience patience) {
    if (!thread_.joinable()) return;
    if (over_.wait_for(patience) == std::future_status::ready)
      thread_.join();
    else
      thread_.detach();
  }

 private:
  std::future<void> over_;
  std::thread thread_;
};

// A notification from a worker, until the receiver silences it.
class Bell {
 public:
  explicit Bell(std::function<void()> notify) : notify_(std::move(notify)) {}
  // On the worker's thread. The receiver must not block, nor silence the bell.
  void ring() {
    const std::lock_guard guard(lock_);
    if (notify_) notify_();
  }
  // Returns when no notification is in progress; none follows.
  void silence() {
    const std::lock_guard guard(lock_);
    notify_ = nullptr;
  }

 private:
  std::mutex lock_;
  std::function<void()> notify_;
};

}  // namespace cerberus::drivers
