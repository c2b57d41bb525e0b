// SPDX-License-Identifier: LGPL-2.1-or-later
// To and fro between 0 and `way`, with rests at both ends and limits of speed and acceleration:
//
//   speed ^      ____                            0 .. rest          stands at 0
//         |     /    \                           .. + leg           goes to `way`
//         +----/------\--------------> time      .. + rest          stands there
//                      rest   \____/             .. + leg           goes back; then anew
//
// leg = way / top + top / acceleration, with top = min(speed, sqrt(way acceleration)). Units are the caller's: metres
// for a walker, radians for a base that turns; times are seconds.
#pragma once

namespace cerberus::sim {

class Shuttle {
 public:
  // way, speed, acceleration > 0; rest >= 0.
  Shuttle(double way, double speed, double acceleration, double rest = 0);

  // Returns the position at `seconds`; before 0 it stands at 0.
  double at(double seconds) const;
  // Returns the first time at which it passes `position`, which lies between 0 and the way.
  double passes(double position) const;
  double period() const { return 2 * (rest_ + leg_); }

 private:
  double on_leg(double seconds) const;

  double way_, acceleration_, rest_;
  double top_, leg_;  // reached speed; seconds
};

}  // namespace cerberus::sim
