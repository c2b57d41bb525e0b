// SPDX-License-Identifier: LGPL-2.1-or-later
// The time of an emulated device: the steady clock, or one that a test moves on.
#pragma once

#include <atomic>
#include <chrono>

namespace cerberus::tests {

class SteppedTime {
 public:
  using Clock = std::chrono::steady_clock;
  void set(std::chrono::nanoseconds now) { now_ = now.count(); }
  std::chrono::nanoseconds now() const { return std::chrono::nanoseconds(now_); }

 private:
  std::atomic<std::chrono::nanoseconds::rep> now_{0};
};

// time: of a test; nullptr: the steady clock.
inline SteppedTime::Clock::time_point now_of(const SteppedTime* time) {
  return time ? SteppedTime::Clock::time_point(time->now()) : SteppedTime::Clock::now();
}

}  // namespace cerberus::tests
