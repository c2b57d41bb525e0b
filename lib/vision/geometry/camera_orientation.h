// SPDX-License-Identifier: LGPL-2.1-or-later
// The camera's orientation: the pose that a head reports or, without one, the sum of the measured camera motion.
#pragma once

#include <optional>

#include "vision/geometry/lens.h"
#include "vision/geometry/transform.h"

namespace cerberus::vision {

struct CameraOrientation {
  Lens lens;
  double pan = 0, tilt = 0;  // radians

  // Magnification of a pinhole picture in direction d relative to its middle, for equal angular sizes: the mean of the
  // radial one, cos^-2 of the angle to the axis, and the tangential one, cos^-1. The angle is limited to 75 degrees,
  // beyond which no picture reaches.
  double magnification(const Direction& d) const;
  Direction direction(Point p) const { return lens.direction(p, pan, tilt); }
  // Returns nullopt for a direction that is not in front of the camera.
  std::optional<Point> project(const Direction& d) const { return lens.project(d, pan, tilt); }
};

class OrientationEstimate {
 public:
  // Field of view assumed for an unknown lens. Its value is uncritical: a place that leaves the picture and returns by
  // as many pixels has the same angles again.
  static constexpr double kUnknownFov = 1.0;  // radians

  void reset() { *this = {}; }
  // Updates the orientation to frame k. reported: the head's pose, with a known lens. motion: frame k-1 to k, frame
  // pixels; the displacement of the middle point gives the angles by which the camera turned (roll and zoom are
  // ignored). Without a reported pose the angles continue from the last reported ones. Returns true when they jump,
  // which is at the first frame of a size and at the first report after frames without one: directions from earlier
  // frames are then invalid.
  bool update(const std::optional<CameraOrientation>& reported, const Transform& motion, Size frame);
  const CameraOrientation& gaze() const { return *gaze_; }
  // The camera is on a head: its pose is reported, or it has turned.
  bool turns() const { return reported_ || turned_; }

 private:
  std::optional<CameraOrientation> gaze_;
  Size frame_;
  bool reported_ = false, turned_ = false;
};

}  // namespace cerberus::vision
