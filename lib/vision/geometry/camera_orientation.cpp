// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/camera_orientation.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

double CameraOrientation::magnification(const Direction& d) const {
  const double ahead = std::cos(d.elevation) * std::cos(d.bearing - pan) * std::cos(tilt) +
                       std::sin(d.elevation) * std::sin(tilt);
  return std::pow(std::clamp(ahead, 0.26, 1.0), -1.5);
}

bool OrientationEstimate::update(const std::optional<CameraOrientation>& told, const Transform& motion,
                                 Size frame) {
  const bool speaks = told && told->lens.known() && std::isfinite(told->pan) && std::isfinite(told->tilt);
  const bool anew =
      !gaze_ || frame.width != frame_.width || frame.height != frame_.height || (speaks && !told_);
  told_ = speaks;
  frame_ = frame;
  if (speaks) {
    gaze_ = *told;
    return anew;
  }
  if (anew) gaze_ = CameraOrientation{Lens(kUnknownFov, frame), 0, 0};
  if (anew || motion.is_identity()) return anew;
  // What was in the middle lies at q now: the camera turned away from it.
  const Point middle{0.5 * (frame.width - 1), 0.5 * (frame.height - 1)}, q = motion.apply(middle);
  if (!std::isfinite(q.x) || !std::isfinite(q.y)) return false;
  const double f = gaze_->lens.focal_length();
  gaze_->pan += std::atan((middle.x - q.x) / f);
  gaze_->tilt += std::atan((q.y - middle.y) / f);
  return false;
}

}  // namespace cerberus::vision
