// SPDX-License-Identifier: LGPL-2.1-or-later
// The motion of a target along one axis, from noisy angles at uneven times: a Kalman filter of constant velocity whose
// acceleration is white noise (Bar-Shalom, Li, Kirubarajan, "Estimation with Applications to Tracking and Navigation",
// 2001, section 6.2.2: the continuous white noise acceleration model). Radians and seconds; allocates nothing.
//
//   x(t + dt) = x + v dt,  v(t + dt) = v,  Q = q [dt^3/3  dt^2/2;  dt^2/2  dt],  angle = x + noise
//   an angle beyond the gate is left out; the third one in a row, or one after a pause, begins anew
#pragma once

namespace cerberus::control {

class TargetFilter {
 public:
  struct Parameters {
    double noise = 0;         // radians, standard deviation of an angle
    double acceleration = 0;  // q, radians^2 / s^3
    double rate = 0;          // radians a second, standard deviation of a new target's rate
  };
  // Seconds between frames, after which nothing is known of the time between them. derived: a camera-found track is given up
  // after as much
  static constexpr double kPause = .5;

  void reset() { known_ = false; }
  bool known() const { return known_; }
  // Adds an angle that was measured at `time`; one that is not later than the last is ignored.
  void add(double time, double angle, const Parameters& parameters);
  double at(double time) const { return x_ + v_ * (time - time_); }
  double rate() const { return v_; }

 private:
  void begin(double time, double angle, const Parameters& parameters);

  bool known_ = false;
  int outliers_ = 0;  // in a row
  double time_ = 0, x_ = 0, v_ = 0;
  double xx_ = 0, xv_ = 0, vv_ = 0;  // covariance
};

}  // namespace cerberus::control
