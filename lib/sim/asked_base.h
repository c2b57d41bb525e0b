// SPDX-License-Identifier: LGPL-2.1-or-later
// The base below a head as a machine that is asked for yaw rates: it turns at no more than its own, begins dead_time after a
// request, and brakes half a second after the last one. Radians and seconds; steps of 1 ms.
#pragma once

#include <algorithm>
#include <deque>

#include "motion/head_limits.h"

namespace cerberus::sim {

using motion::Time;

class AskedBase {
 public:
  struct Traits {
    double speed = sensing::radians(45);         // a second
    double acceleration = sensing::radians(90);  // a second squared
    double dead_time = .2;
    double longest = .5;  // a request holds
  };
  AskedBase() = default;
  explicit AskedBase(const Traits& traits) : traits_(traits) {}

  void ask(double yaw_rate, Time now) { coming_.push_back({motion::seconds(now), yaw_rate}); }
  // A millisecond.
  void step(Time now) {
    const double t = motion::seconds(now);
    while (!coming_.empty() && coming_.front().time + traits_.dead_time <= t) {
      asked_ = coming_.front();
      coming_.pop_front();
    }
    constexpr double kStep = .001;
    const bool holds = t < asked_.time + traits_.dead_time + traits_.longest;
    const double wanted = holds ? std::clamp(asked_.rate, -traits_.speed, traits_.speed) : 0;
    const double most = traits_.acceleration * kStep;
    rate_ += std::clamp(wanted - rate_, -most, most);
    yaw_ += rate_ * kStep;
  }
  double yaw() const { return yaw_; }

 private:
  struct Request {
    double time = -1, rate = 0;
  };
  Traits traits_;
  std::deque<Request> coming_;
  Request asked_;
  double rate_ = 0, yaw_ = 0;
};

}  // namespace cerberus::sim
