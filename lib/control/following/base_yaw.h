// SPDX-License-Identifier: LGPL-2.1-or-later
// The yaw of the base below a head, for the law that follows in the world's frame: as reported (a gyro, an application),
// and what the picture shows beyond that. Only its change between a picture and the effect of a command counts.
//
//   yaw   += reported + (picture's turn - reported - turn of the head's pose)
//   rate   = reported / dt + low-pass of (picture's turn - reported - turn that the head's driver reckons) / dt
//
// The second part of the rate is also what a wrong speed table or a head that slips makes of its commands. It is as slow
// as the head: while a dead time is wrong by some part, every change of speed looks like a turn of the base. Radians.
#pragma once

#include <optional>

#include "control/base_rate.h"
#include "control/following/followed_axis.h"
#include "motion/head_limits.h"

namespace cerberus::control {

class BaseYaw {
 public:
  struct Parameters {
    // Of the low-pass, in dead times of the head. swept: 2 to 4; less and heads of wrong dead times swing (B, near), more
    // and a base that turns without a gyro is followed later (A, nogyro).
    double slowness = 3;
  };

  // The head at a frame.
  struct Head {
    double pan = 0;        // of its pose
    double reckoned = 0;   // by the driver, before any correction
    double dead_time = 0;  // seconds
  };

  void reset() { *this = {}; }
  // Adds a frame. turn: of the picture since the frame before, less the reported one; nothing: not measured.
  void on_frame(motion::Time taken, double reported, const std::optional<Turn>& turn, const Head& head);
  // effect: when the command takes effect.
  BaseTurn at(motion::Time effect) const;

 private:
  std::optional<motion::Time> taken_;
  Head head_;
  double yaw_ = 0, reported_rate_ = 0, other_rate_ = 0;
};

}  // namespace cerberus::control
