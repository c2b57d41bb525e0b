// SPDX-License-Identifier: LGPL-2.1-or-later
// When a part that failed is tried again: after 1 s, then twice as late each time, at most after a minute.
#pragma once

#include <algorithm>
#include <chrono>

namespace cerberus::robot {

class Backoff {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  // Convention of services that reconnect: seconds at first, so that a loose plug is noticed at once; a minute at most,
  // so that a camera that is switched on again is not missed for long.
  struct Parameters {
    Duration first = std::chrono::seconds(1), longest = std::chrono::seconds(60);
    Duration sound =
        std::chrono::seconds(60);  // so long without a failure, and the next one counts as the first
  };

  Backoff() = default;
  explicit Backoff(const Parameters& parameters) : parameters_(parameters) {}

  // Notes a failure; returns how long to wait.
  Duration failed(Time now) {
    if (failures_ == 0 || now - due_ >= parameters_.sound)
      wait_ = parameters_.first;
    else
      wait_ = std::min(2 * wait_, parameters_.longest);
    ++failures_;
    due_ = now + wait_;
    return wait_;
  }
  bool is_due(Time now) const { return now >= due_; }

 private:
  Parameters parameters_;
  int failures_ = 0;
  Duration wait_{};
  Time due_{};
};

}  // namespace cerberus::robot
