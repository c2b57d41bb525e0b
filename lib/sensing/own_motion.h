// SPDX-License-Identifier: LGPL-2.1-or-later
// What a body's own motion does to its PIR sensors: standing things that are warm or cold pass their zones and trigger
// them as a person would, and a module then holds its output for some seconds.
#pragma once

#include <chrono>
#include <limits>

#include "sensing/angles.h"
#include "sensing/sectors.h"

namespace cerberus::sensing {

using Time = std::chrono::nanoseconds;
constexpr Time kNever = Time::max();

struct BodyMotion {
  double yaw_rate = std::numeric_limits<double>::quiet_NaN();  // radians a second; NaN: unknown, taken as 0
  double speed = std::numeric_limits<double>::quiet_NaN();  // metres a second, straight ahead; NaN as above
};

// Things that pass a sensor faster than this trigger it: 5 degrees a second, an assumption.
constexpr double kDoubtfulTurn = radians(5);
// A reported motion expires after this time. A robot reports it many times a second; after a second without a report
// the source has failed, and its last value must not suppress detections for ever.
constexpr Time kBaseLifetime = std::chrono::seconds(1);
// A module holds its output for some seconds after what triggered it last.
constexpr Time kDoubtLinger = std::chrono::seconds(3);

// Returns the greatest rate, radians a second, at which standing things pass a sensor: |yaw rate| + |speed| max |sin b| /
// kNearest over the bearings b of its field. A sensor that looks ahead sees less of a straight way than one to the side.
double passing_rate(const Arc& field, const BodyMotion& motion);

// Decides whether the output of one sensor counts. A detection is sure from its last evidence on for kDoubtLinger:
//
//   a rise while the body did not move, nor kSettle before
//   any moment of a high output while the body did not move, nor kDoubtLinger before: nothing else can hold it
//
// Times do not go back (an earlier one counts as the last). Never allocates.
class PulseDoubt {
 public:
  // Sets the output and whether the body moves (passing_rate() > kDoubtfulTurn) from `time` on.
  void update(Time time, bool high, bool moves);
  bool doubtful() const { return doubtful_; }
  // Returns the time at which doubtful() changes if nothing else does: call update() then. kNever: it does not.
  Time due() const;

  // Modules answer a little late, and reports of the body's motion are a little old: assumed. Guarded by bench-pir_search.
  static constexpr Time kSettle = std::chrono::milliseconds(300);

 private:
  static constexpr Time kLongAgo = Time::min() / 2;

  Time time_ = kLongAgo;
  bool high_ = false, moves_ = false, doubtful_ = false;
  Time moved_ = kLongAgo;     // last time the body moved
  Time evidence_ = kLongAgo;  // last time at which only a person explains the output
};

}  // namespace cerberus::sensing
