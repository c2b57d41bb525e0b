// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/camera.h"

#include <cmath>

namespace cerberus::sim {

void Camera::look_through(double field_of_view) {
  const double scale = std::tan(field_of_view / 2) / std::tan(traits_.field_of_view / 2);
  traits_.field_of_view = field_of_view;
  traits_.box_noise *= scale;
  traits_.edge *= scale;
  traits_.turn_noise *= scale;
  noise_ *= scale;
}

Picture Camera::take(Time now, double off, double direction, bool there) {
  ++taken_;
  next_ = Time(static_cast<Time::rep>(std::llround(static_cast<double>(taken_) / traits_.frames * 1e9)));
  // A first-order process of the same standard deviation: x = a x + sqrt(1 - a^2) noise, a = exp(-dt / wander).
  const double a = traits_.wander > 0 ? std::exp(-1 / (traits_.frames * traits_.wander)) : 0;
  noise_ = a * noise_ + std::sqrt(1 - a * a) * traits_.box_noise * gauss_(random_);
  Picture picture;
  picture.taken = now;
  picture.field_of_view = traits_.field_of_view;
  picture.seen = there && std::abs(off) < traits_.field_of_view / 2 - traits_.edge;
  picture.off = off + noise_;
  picture.turn = direction - direction_ + traits_.turn_noise * gauss_(random_);
  direction_ = direction;
  return picture;
}

}  // namespace cerberus::sim
