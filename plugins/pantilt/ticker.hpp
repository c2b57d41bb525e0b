// SPDX-License-Identifier: LGPL-2.1-or-later
// The thread that calls a clock-driven element at the clock's times.
#pragma once

#include <gst/gst.h>

#include <atomic>
#include <functional>
#include <mutex>

namespace cerberus::plugin {

class Ticker {
 public:
  // Called with the clock's time; returns the time of the next call.
  using Tick = std::function<GstClockTime(GstClockTime)>;

  ~Ticker() { stop(); }
  // Nothing when it runs already. False: the system has no thread for
  // it. One thread at a time, and not its own, starts and stops it.
  bool start(GstClock* clock, Tick tick);
  void stop();
  // The next call comes at once. From any thread; a wake-up before the wait is not lost.
  void wake();

 private:
  void run();

  GThread* thread_ = nullptr;
  GstClock* clock_ = nullptr;  // while there is a thread, as what follows
  Tick tick_;
  std::mutex lock_;  // id_
  GstClockID id_ = nullptr;
  std::atomic<bool> quit_ = false, woken_ = false;
};

}  // namespace cerberus::plugin
