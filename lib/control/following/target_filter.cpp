// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/target_filter.h"

namespace cerberus::control {

namespace {

constexpr double kGate = 4;   // sigma. derived: one angle in 16,000 of white noise lies beyond
constexpr int kOutliers = 3;  // in a row: the target is elsewhere

}  // namespace

void TargetFilter::begin(double time, double angle, const Parameters& p) {
  *this = {};
  known_ = true;
  time_ = time;
  x_ = angle;
  xx_ = p.noise * p.noise;
  vv_ = p.rate * p.rate;
}

void TargetFilter::add(double time, double angle, const Parameters& p) {
  if (!known_ || time - time_ > kPause) return begin(time, angle, p);
  const double dt = time - time_;
  if (!(dt > 0)) return;
  time_ = time;
  x_ += v_ * dt;
  xx_ += dt * (2 * xv_ + dt * vv_) + p.acceleration * dt * dt * dt / 3;
  xv_ += dt * vv_ + p.acceleration * dt * dt / 2;
  vv_ += p.acceleration * dt;
  const double s = xx_ + p.noise * p.noise, innovation = angle - x_;
  if (innovation * innovation > kGate * kGate * s) {
    if (++outliers_ >= kOutliers) begin(time, angle, p);
    return;
  }
  outliers_ = 0;
  const double kx = xx_ / s, kv = xv_ / s;
  x_ += kx * innovation;
  v_ += kv * innovation;
  vv_ -= kv * xv_;
  xv_ -= kx * xv_;
  xx_ -= kx * xx_;
}

}  // namespace cerberus::control
