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

bool OrientationEstimate::update(const std::optional<CameraOrientation>& reported, const Transform& motion,
                                 Size frame) {
  const bool usable =
      reported && reported->lens.known() && std::isfinite(reported->pan) && std::isfinite(reported->tilt);
  const bool anew =
      !gaze_ || frame.width != frame_.width || frame.height != frame_.height || (usable && !reported_);
  reported_ = usable;
  turned_ = turned_ || !motion.is_identity();
  frame_ = frame;
  if (usable) {
    gaze_ = *reported;
    return anew;
  }
  if (anew) gaze_ = CameraOrientation{Lens(kUnknownFov, frame), 0, 0};
  if (anew || motion.is_identity()) return anew;
  // q is the new place of the point that was in the middle: the camera turned by the angle between them.
  const Point middle{0.5 * (frame.width - 1), 0.5 * (frame.height - 1)}, q = motion.apply(middle);
  if (!std::isfinite(q.x) || !std::isfinite(q.y)) return false;
  const double f = gaze_->lens.focal_length();
  gaze_->pan += std::atan((middle.x - q.x) / f);
  gaze_->tilt += std::atan((q.y - middle.y) / f);
  return false;
}

}  // namespace cerberus::vision
