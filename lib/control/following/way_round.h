// SPDX-License-Identifier: LGPL-2.1-or-later
// A target that crosses behind a head with stops: whether the head waits at its stop or turns all the way round, by which of
// both the target is in the picture sooner, and the turn itself, during which nothing is seen.
//
//   target  x(t) = x + v t, beyond the stop s of its side; seen while it is within `view` of the head
//   wait    max((s - head) / speed, (x - view - s) / -v); never, where it moves on out of view
//   round   max((head - view - (x - 2 pi)) / (speed + v) + speed / (2 a) + d,  (from - view - (x - 2 pi)) / v)
//
// written for the right side; a = the head's acceleration, d = its dead time, `from` = its other stop, from which the
// target must be in view. The head leaves a target that is in view only when it is about to leave by itself. While it turns,
// it goes to where the target is predicted, and to the other stop once it has passed that place. Radians and seconds.
#pragma once

#include <optional>

#include "motion/profile.h"

namespace cerberus::control {

class WayRound {
 public:
  // Guarded by unit-way_round and bench-heads (behind).
  struct Parameters {
    double seen =
        .8;  // of half the view: a box nearer to the edge is cut by it. derived: half a person 3 m away
    double unknown = .35;  // radians: the same, of a lens of which nothing is known. derived: of 50 degrees
    double warning = .3;   // seconds. derived: the dead times of picture and head together
    double longest = 8;    // seconds. chosen: what a person does later is not predicted
    // Of the time of the way round: the other way must be so much shorter for the head to turn back. chosen
    double worth = .7;
    double patience = 1.5;  // seconds after the predicted meeting. derived: a person that became half as fast
  };
  // The target when the command takes effect, and the head then.
  struct Situation {
    double target = 0, rate = 0;
    double head = 0;
    double view = 0;                   // the camera's, over the picture's width; 0: not known
    double effect = 0, dead_time = 0;  // seconds
  };

  void end() { side_ = 0; }
  bool active() const { return side_ != 0; }
  // Whether a target that is seen there is still the one that was left behind.
  bool leaves_behind(double target, const motion::AxisLimits& limits) const {
    return side_ > 0 ? target > limits.to : target < limits.from;
  }
  // Of a target that is seen beyond a stop: whether the head goes round, or goes on to. False: it is to wait at the stop.
  bool decide(const Situation& now, const motion::AxisLimits& limits);
  // The command at a time of effect, as long as the turn lasts; nothing: there is none, or it is over without a meeting.
  std::optional<motion::AxisCommand> command(double effect, double head, const motion::AxisLimits& limits);

 private:
  double side_ = 0;                          // 1: the target went out to the right; -1; 0: no turn
  double target_ = 0, rate_ = 0, time_ = 0;  // as seen last
  double deadline_ = 0;                      // seconds
  bool passed_ = false;                      // the place where it should have been
};

}  // namespace cerberus::control
