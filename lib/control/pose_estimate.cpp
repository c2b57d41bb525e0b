// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/pose_estimate.h"

#include <algorithm>
#include <cmath>

namespace cerberus::control {

void PoseEstimate::reset(const motion::PanTilt& at, double uncertainty) {
  pan_ = {at.pan, at.pan, uncertainty * uncertainty, 0};
  tilt_ = {at.tilt, at.tilt, uncertainty * uncertainty, 0};
}

void PoseEstimate::add(Axis& axis, double u, const double* seen) const {
  const Parameters& p = parameters_;
  const double s_u = p.reckoning_scale * std::abs(u);
  if (!seen || !std::isfinite(*seen)) {
    axis.position += u;
    axis.unseen += s_u;
    return;
  }
  const double z = *seen, s_z = p.picture_noise + p.picture_scale * std::abs(z);
  const double var_u = s_u * s_u, var_z = p.picture_noise * p.picture_noise;
  if (std::abs(z - u) > p.gate * (s_u + s_z) + p.slack) {
    axis.position += z;
    axis.variance += var_z;
    return;
  }
  const double weight = var_u / (var_u + s_z * s_z);
  axis.position += u + weight * (z - u);
  // Only the noise of both adds up at random; the scale of the picture counts by the distance from the reference.
  axis.variance += weight * var_z;
}

void PoseEstimate::add(const motion::PanTilt& reckoned, const std::optional<Turn>& seen) {
  add(pan_, reckoned.pan, seen ? &seen->yaw : nullptr);
  add(tilt_, reckoned.tilt, seen ? &seen->pitch : nullptr);
}

double PoseEstimate::uncertainty(const Axis& axis) const {
  return std::sqrt(axis.variance) + axis.unseen +
         parameters_.picture_scale * std::abs(axis.position - axis.reference);
}

double PoseEstimate::uncertainty() const {
  return std::max(uncertainty(pan_), uncertainty(tilt_));
}

}  // namespace cerberus::control
