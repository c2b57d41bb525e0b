// SPDX-License-Identifier: LGPL-2.1-or-later
// A person who follows a list of instructions through a floor plan. Its acceleration is limited, also where it gives way.
// Metres, seconds, radians; bearings clockwise from x.
#pragma once

#include <optional>
#include <vector>

#include "motion/head_limits.h"
#include "sim/house/ways.h"

namespace cerberus::sim {

using motion::Time;

struct Instruction {
  enum Kind { go, stand, gesture };
  Kind kind = stand;
  double x = 0, y = 0;  // go: to here
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
  // A velocity that is added to that of its way from now on: it makes room for others.
  void give_way(const Spot& velocity) { aside_ = velocity; }
  // A wall or a thing stops it at a place; it keeps its velocity along what it touches.
  void stop_at(const Spot& place);
  // It touches somebody and is at a place; away: the direction, of length 1, against which it moves no further.
  void touch(const Spot& place, const Spot& away);
  const Instruction& now() const { return detour_.empty() ? instructions_[current_] : detour_.front(); }
  // What comes after now().
  const Instruction& then() const;
  // While it goes: for how long it has come hardly nearer to its place, seconds.
  double held_up() const { return held_up_; }
  // Its place counts as reached.
  void arrive() { next(); }
  // Where it stood or passed an end of a way last, and where its present way ends.
  const Spot& origin() const { return origin_; }
  Spot destination() const;
  bool returns() const { return returns_; }
  // Goes to the destination along other corners, of which that is the last.
  void lead(std::vector<Spot> way);
  // Goes back to the origin along these corners, then on its way again.
  void send_back(const std::vector<Spot>& way);
  const Stance& stance() const { return stance_; }
  const Spot& velocity() const { return velocity_; }
  double height() const { return traits_.height; }

 private:
  void step();
  double corner_speed(const Instruction& to) const;
  std::optional<Spot> towards(const Instruction& to);
  void follow(const std::vector<Spot>& corners);
  void next();
  std::size_t last_of_way() const;

  Traits traits_;
  std::vector<Instruction> instructions_, detour_;
  std::size_t current_ = 0, first_of_way_ = 0;
  double in_instruction_ = 0, held_up_ = 0;  // seconds
  double nearest_ = 1e9;                     // to the place where it goes
  bool returns_ = false;
  Spot velocity_, aside_, origin_;
  Stance stance_;
  Time done_{};
};

}  // namespace cerberus::sim
