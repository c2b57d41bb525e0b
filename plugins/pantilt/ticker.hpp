// SPDX-License-Identifier: LGPL-2.1-or-later
// The thread that lets the clock's time pass in a clock-driven element.
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <functional>
#include <mutex>
#include <thread>

namespace cerberus::plugin {

class Ticker {
 public:
  // Does what is due at the clock's time, returns that of the next call.
  using Tick = std::function<GstClockTime(GstClockTime)>;

  ~Ticker() { stop(); }
  // Nothing when it runs already. One thread at a time, and not its own, starts and stops it.
  void start(GstClock* clock, Tick tick);
  void stop();
  // The next call comes at once. From any thread; a wake-up before the wait is not lost.
  void wake();

 private:
  void run(GstClock* clock, const Tick& tick);

  std::thread thread_;
  std::mutex lock_;  // id_
  GstClockID id_ = nullptr;
  std::atomic<bool> quit_ = false, woken_ = false;
};

}  // namespace cerberus::plugin
