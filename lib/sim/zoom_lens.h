// SPDX-License-Identifier: LGPL-2.1-or-later
// The zoom of a camera as a machine: goes to the field of view that was commanded last, at its own speed, and reports where
// it is. Radians and seconds; only the horizontal angle.
//
//   log tan(field of view / 2) goes to the commanded one by `speed` a second, from dead_time after the command on
#pragma once

#include <deque>

#include "motion/profile.h"

namespace cerberus::sim {

using motion::Time;

struct ZoomTraits {
  double widest = sensing::radians(60), narrowest = sensing::radians(4);
  double speed = 1;        // 1/s. derived: a lens of 20 times takes three seconds from end to end
  double dead_time = .15;  // seconds
  double reports = 2;      // a second
};

class ZoomLens {
 public:
  explicit ZoomLens(const ZoomTraits& traits) : traits_(traits), seen_(traits.widest), told_(traits.widest) {}

  void command(double field_of_view, Time now) { coming_.push_back({now, field_of_view}); }
  void elapse(Time until);
  double field_of_view() const { return seen_; }
  double reported() const { return told_; }

 private:
  struct Command {
    Time given{};
    double field_of_view = 0;
  };
  ZoomTraits traits_;
  std::deque<Command> coming_;
  double wanted_ = 0;  // 0: nothing was commanded
  double seen_, told_;
  Time now_{}, next_report_{};
};

}  // namespace cerberus::sim
