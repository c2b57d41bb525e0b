// SPDX-License-Identifier: LGPL-2.1-or-later
// Limits how often something is reported: a burst at once, then one each interval. Time is a parameter.
#pragma once

#include <algorithm>
#include <chrono>

namespace cerberus::publish {

class BurstLimit {
 public:
  struct Parameters {
    double burst = 10;  // convention: a person's mistakes in a row are all reported
    std::chrono::nanoseconds interval = std::chrono::seconds(1);  // between two reports of a flood
  };

  // Whether one more may be reported at `now`, which never decreases.
  bool take(std::chrono::nanoseconds now) {
    if (last_ != std::chrono::nanoseconds{})
      left_ = std::min(parameters_.burst, left_ + std::chrono::duration<double>(now - last_) /
                                                      std::chrono::duration<double>(parameters_.interval));
    last_ = now;
    if (left_ < 1) return false;
    left_ -= 1;
    return true;
  }

 private:
  Parameters parameters_;
  double left_ = parameters_.burst;
  std::chrono::nanoseconds last_{};
};

}  // namespace cerberus::publish
