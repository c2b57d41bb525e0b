// SPDX-License-Identifier: LGPL-2.1-or-later
// A robot's base that drives through a floor plan, and what shakes the camera on it. Metres, seconds, radians; bearings
// clockwise from x.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "motion/head_limits.h"
#include "sensing/angles.h"

namespace cerberus::sim {

using motion::Time;

struct Leg {
  enum Kind { drive, turn, wait };
  Kind kind = wait;
  double x = 0, y = 0;  // drive: to here, after it has turned there
  double angle = 0;     // turn: by so much
  double speed = .6;    // drive: to 1.5 a second
  double seconds = 1;   // wait
};

class DrivenBase {
 public:
  struct Traits {
    double yaw_rate = sensing::radians(45);           // a second, at most 60 degrees
    double acceleration = .8;                         // a second squared
    double yaw_acceleration = sensing::radians(180);  // a second squared
  };
  // The legs are repeated from the first one; while there is none, it stands.
  DrivenBase(double x, double y, double yaw, std::vector<Leg> legs, const Traits& traits);

  // In steps of 2 ms.
  void elapse(Time now);
  // Something stands in its way: it brakes. Where that lasts it backs a little, and drives on then.
  void block(bool blocked) { blocked_ = blocked; }
  bool backs() const { return backs_; }
  double x() const { return x_; }
  double y() const { return y_; }
  double yaw() const { return yaw_; }
  double speed() const { return speed_; }  // below 0: it backs
  double yaw_rate() const { return rate_; }

 private:
  void step();
  void wait_or_turn_back();
  // Comes nearer to an angle that is so far away; true: it is there and rests.
  bool turn(double away);
  void next();

  Traits traits_;
  std::vector<Leg> legs_;
  std::size_t current_ = 0;
  double in_leg_ = 0, turned_to_ = 0;
  double waited_ = 0;   // seconds, before what is in its way
  double to_back_ = 0;  // metres
  bool aims_ = true, blocked_ = false, backs_ = false;
  double x_, y_, yaw_, speed_ = 0, rate_ = 0;
  Time done_{};
};

// A sum of sines at seeded frequencies between two: the angle by which a camera is off at a time.
class Shake {
 public:
  // rms: radians; low, high: Hz
  Shake(double rms, double low, double high, std::uint32_t seed);
  double at(double seconds) const;

 private:
  static constexpr int kSines = 6;
  double amplitude_;
  std::array<double, kSines> rate_, phase_;
};

}  // namespace cerberus::sim
