// SPDX-License-Identifier: LGPL-2.1-or-later
// Asks the base below a head to turn, so that a target that goes beyond the head's stops stays within them.
//
//   p    = target + rate x ahead, beyond the stop s by p - (s - near): the request begins
//   rate = min(most, gain (p - (s - room))), to the target's side, until p is `room` within the stop
//
// Radians and seconds, to the right positive. Whatever asks stops asking when the target is not seen.
#pragma once

#include "motion/head_limits.h"

namespace cerberus::control {

class BaseRequest {
 public:
  // Guarded by unit-base_request and bench-heads (turned).
  struct Parameters {
    double ahead = .7;  // seconds. derived: a base takes as long to follow an order
    // At most a quarter of the way to the stop. derived: a third of a usual view, in which a base reaches a walker's rate
    double near = sensing::radians(20);
    double room = sensing::radians(45);  // at most half of the way from straight ahead to the stop
    double gain = 1;                     // 1/s. derived: the room closes within a second
    double least = sensing::radians(1);  // a second; less is not asked for. derived: bases creep no slower
  };

  void end() { side_ = 0; }
  // The yaw rate to ask for; 0: none. most: more is not asked for.
  double update(double target, double rate, const motion::AxisLimits& limits, double most);

 private:
  double side_ = 0;  // to which the base is to turn; 0: it is not asked
};

}  // namespace cerberus::control
