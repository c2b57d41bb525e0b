// SPDX-License-Identifier: LGPL-2.1-or-later
// Watches the positions that a head reports while it is turned at one speed by hand: it ends at the limits, whichever way
// the reports count, and where they part from the speed (motion/report_watch.h). Pure.
#pragma once

#include <optional>
#include <string>

#include "motion/pan_tilt.h"
#include "motion/report_watch.h"

namespace cerberus::control {

class MoveCheck {
 public:
  // speed: radians a second; latency: seconds from a command until it takes effect.
  MoveCheck(const motion::Limits& limits, const motion::PanTilt& speed, double latency)
      : limits_(limits), speed_(speed), latency_(latency) {}

  // Adds a report of `time` (radians; NaN: no number), of a head that turns since the first one. Returns false if the head
  // is to be stopped: at a limit, or by a fault.
  bool add(motion::Time time, const motion::PanTilt& reported);
  // Empty: the reports do not part from the speed.
  const std::string& fault() const { return fault_; }

 private:
  struct Axis {
    motion::ReportWatch watch;
    double start = 0, beyond = 0;  // radians; how far beyond the limits it was at the start
  };
  bool add(Axis& axis, const char* name, motion::Time time, double reported, double speed,
           const motion::AxisLimits& limits);

  motion::Limits limits_;
  motion::PanTilt speed_;
  double latency_;
  std::optional<motion::Time> begin_;
  Axis pan_, tilt_;
  std::string fault_;
};

}  // namespace cerberus::control
