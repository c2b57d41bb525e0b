// SPDX-License-Identifier: LGPL-2.1-or-later
// Decides when the zoom is set to where it is to be kept.
#pragma once

#include <chrono>
#include <cmath>

#include "motion/profile.h"

namespace cerberus::drivers::onvif {

class ZoomLock {
 public:
  using Time = motion::Time;
  // wanted: 0 to 1; negative: the zoom is left alone.
  explicit ZoomLock(double wanted) : wanted_(wanted) {}

  // Takes a reported position. True: the zoom is to be set now.
  bool on_zoom(double position, Time now) const {
    return wanted_ >= 0 && std::abs(position - wanted_) > kSlack && now - sent_ >= Time(kPatience);
  }
  void on_sent(Time now) { sent_ = now; }

 private:
  static constexpr double kSlack = 0.01;                       // of the range: cameras round
  static constexpr std::chrono::milliseconds kPatience{5000};  // from one end of the lens to the other

  double wanted_;
  Time sent_{-std::chrono::duration_cast<Time>(kPatience)};
};

}  // namespace cerberus::drivers::onvif
