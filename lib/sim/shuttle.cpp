// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/shuttle.h"

#include <algorithm>
#include <cmath>

namespace cerberus::sim {

Shuttle::Shuttle(double way, double speed, double acceleration, double rest)
    : way_(way),
      acceleration_(acceleration),
      rest_(rest),
      top_(std::min(speed, std::sqrt(way * acceleration))),
      leg_(way / top_ + top_ / acceleration) {}

double Shuttle::on_leg(double seconds) const {
  const double t = std::clamp(seconds, 0.0, leg_);
  const double ramp = top_ / acceleration_;
  const double gone = [&](double s) {
    return s < ramp ? acceleration_ * s * s / 2 : acceleration_ * ramp * ramp / 2 + top_ * (s - ramp);
  }(std::min(t, leg_ - t));
  // Both halves are mirror images: the second one is what is left.
  return t <= leg_ / 2 ? gone : way_ - gone;
}

double Shuttle::at(double seconds) const {
  const double t = std::fmod(std::max(0.0, seconds), period());
  return on_leg(t - rest_) - on_leg(t - 2 * rest_ - leg_);
}

double Shuttle::passes(double position) const {
  const bool late = position > way_ / 2;
  const double gone = std::clamp(late ? way_ - position : position, 0.0, way_ / 2);
  const double ramp = top_ / acceleration_, on_ramp = top_ * ramp / 2;
  const double t = gone < on_ramp ? std::sqrt(2 * gone / acceleration_) : ramp + (gone - on_ramp) / top_;
  return rest_ + (late ? leg_ - t : t);
}

}  // namespace cerberus::sim
