// SPDX-License-Identifier: LGPL-2.1-or-later
// A person who follows a list of instructions through a floor plan. Metres, seconds, radians; bearings clockwise from x.
#pragma once

#include <vector>

#include "motion/head_limits.h"

namespace cerberus::sim {

using motion::Time;

struct Instruction {
  enum Kind { go, stand, gesture, face };
  Kind kind = stand;
  double x = 0, y = 0;  // go: to here; face: towards it
  double speed = 1.2;   // go: .1 to 4 a second
  double seconds = 1;   // stand, gesture
  bool stops = false;   // go: comes to rest there
};

// What a figure is drawn from.
struct Stance {
  double x = 0, y = 0, heading = 0, speed = 0;
  double phase = 0;    // of the gait, radians: left leg foremost at pi / 2
  double step = 0;     // length of one step
  double gesture = 0;  // 0: arms hang; 1: the right hand is above the head
  double wave = 0;     // radians: phase of the waving hand
};

class Walker {
 public:
  struct Traits {
    double height = 1.75;
    double acceleration = 2;  // a second squared, at most 3
    double turn_rate = 4.2;   // a second
  };
  // The first instruction that goes begins at x, y. The list is repeated from its first instruction.
  Walker(double x, double y, double heading, std::vector<Instruction> instructions, const Traits& traits);

  // In steps of 2 ms.
  void elapse(Time now);
  // Steps aside by so many metres, and goes on from there.
  void shift(double x, double y) { stance_.x += x, stance_.y += y; }
  const Instruction& now() const { return instructions_[current_]; }
  const Stance& stance() const { return stance_; }
  double height() const { return traits_.height; }

 private:
  void step();
  double corner_speed(const Instruction& to) const;
  void go(const Instruction& to);
  void next();

  Traits traits_;
  std::vector<Instruction> instructions_;
  std::size_t current_ = 0;
  double in_instruction_ = 0;     // seconds
  double way_x_ = 0, way_y_ = 0;  // velocity
  Stance stance_;
  Time done_{};
};

}  // namespace cerberus::sim
