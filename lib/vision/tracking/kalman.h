// SPDX-License-Identifier: LGPL-2.1-or-later
// The two small filters a track is made of (R. E. Kalman, "A new approach to linear filtering and prediction
// problems", 1960). Axes are independent, so 2x2 matrices written out are all there is.
#pragma once

namespace cerberus::vision {

constexpr double square(double v) {
  return v * v;
}

// Position and velocity along one axis, constant velocity disturbed by white acceleration noise.
struct MovingValue {
  double position = 0, velocity = 0;
  double pp = 0, pv = 0, vv = 0;  // covariance

  // `intensity`: power of the acceleration noise, units^2 / s^3: after t seconds the velocity's standard
  // deviation has grown by sqrt(intensity t).  x := F x, P := F P F' + Q with F = [1 t; 0 1], Q = intensity
  // [t^3/3 t^2/2; t^2/2 t] (continuous white noise acceleration).
  void predict(double seconds, double intensity) {
    const double t = seconds;
    position += velocity * t;
    pp += t * (2 * pv + t * vv) + intensity * t * t * t / 3;
    pv += t * vv + intensity * t * t / 2;
    vv += intensity * t;
  }

  // The velocity of the last t seconds may have been off by so much.
  void doubt_velocity(double deviation, double t) {
    const double more = deviation * deviation;
    pp += more * t * t;
    pv += more * t;
    vv += more;
  }

  // A measurement of the position that is `residual` away from the predicted one and has this variance.
  void correct(double residual, double variance) {
    const double s = pp + variance;
    if (!(s > 0)) return;
    const double kp = pp / s, kv = pv / s;
    position += kp * residual;
    velocity += kv * residual;
    vv -= kv * pv;
    pv -= kp * pv;
    pp -= kp * pp;
  }
};

// A number that wanders slowly.
struct SlowValue {
  double value = 0, variance = 0;

  void predict(double seconds, double intensity) { variance += intensity * seconds; }
  void correct(double measured, double measured_variance) {
    const double k = variance / (variance + measured_variance);
    value += k * (measured - value);
    variance -= k * variance;
  }
};

}  // namespace cerberus::vision
