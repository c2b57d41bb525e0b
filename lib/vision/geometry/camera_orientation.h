// SPDX-License-Identifier: LGPL-2.1-or-later
// Which way the camera looks: what a head says of it, or, where nobody says, what the camera's own motion sums up to.
#pragma once

#include <optional>

#include "vision/geometry/lens.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

struct CameraOrientation {
  Lens lens;
  double pan = 0, tilt = 0;  // radians

  // How much larger a pinhole's picture shows there than in its middle what is as large seen from the camera: the mean
  // of both ways, cos^-2 of the angle to the axis and cos^-1 across. Ends at 75 degrees, where pictures do.
  double magnification(const Direction& d) const;
  Direction direction(Point p) const { return lens.direction(p, pan, tilt); }
  // Nothing: it is not in front of the camera.
  std::optional<Point> project(const Direction& d) const { return lens.project(d, pan, tilt); }
};

class OrientationEstimate {
 public:
  // Any angle will do where the lens is not known: what turns away and comes back by as many pixels is in its old
  // place.
  static constexpr double kUnknownFov = 1.0;  // radians

  void reset() { gaze_.reset(); }
  // told: by the head, with a known lens. motion: frame k-1 to k, frame pixels; the path of the point in the middle
  // tells by which angles the camera turned (roll and zoom are left out). Angles go on from the last ones told, and
  // jump when a head speaks after silence: true then, and for the first frame; what was placed by the old ones is
  // nowhere.
  bool update(const std::optional<CameraOrientation>& told, const Transform& motion, Size frame);
  const CameraOrientation& gaze() const { return *gaze_; }

 private:
  std::optional<CameraOrientation> gaze_;
  Size frame_;
  bool told_ = false;
};

}  // namespace cerberus::vision
