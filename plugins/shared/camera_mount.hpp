// SPDX-License-Identifier: LGPL-2.1-or-later
// The mounting of the camera in the room: the properties that motionregions and motiontrack share.
#pragma once

#include <cerberus/cerberus.h>

#include <cmath>
#include <limits>
#include <optional>

#include "control/base_rate.h"
#include "sensing/angles.h"

namespace cerberus::plugin {

inline constexpr double kDefaultMountingHeight = 0.8;  // metres, as on the paper's robot (III)
inline constexpr double kMaximumFieldOfView = 179, kMaximumMountingHeight = 100, kMaximumTilt = 90;

inline constexpr char kFieldOfViewBlurb[] =
    "Angle in degrees that the lens sees over the frame's whole width: with it, limits in metres are judged "
    "and bearing "
    "and distance of objects are known; 0 = unknown. Where a head's pose on the frame says what its zoom "
    "sees, "
    "that counts instead";
inline constexpr char kMountingHeightBlurb[] =
    "Height in metres of the lens above the floor on which people walk; the camera is level unless "
    "tilt or a head's pose on the frame gives another angle";
inline constexpr char kTiltBlurb[] =
    "Angle in degrees by which the camera looks up, negative: down; where a head's pose is on the frame, "
    "that counts instead";

using sensing::degrees;
using sensing::radians;

// Returns the head's direction at `running_time` from `pose`; nullopt if not finite or beyond 90 degrees of tilt: poses
// from other elements are not trusted.
inline std::optional<motion::PanTilt> look_of(const CerberusPose& pose, GstClockTime running_time) {
  double pan = 0, tilt = 0;
  cerberus_pose_evaluate(&pose, running_time, &pan, &tilt);
  if (!std::isfinite(pan) || !(std::abs(tilt) <= kMaximumTilt)) return std::nullopt;
  return motion::PanTilt{radians(pan), radians(tilt)};
}
// Returns what the camera sees over the frame's width, radians, as the head's zoom says; 0: the pose does not say it;
// NaN: the head has a zoom, and what it sees is not known.
inline double field_of_view_of(const CerberusPose& pose) {
  if (pose.field_of_view < 0) return std::numeric_limits<double>::quiet_NaN();
  const bool sane = pose.field_of_view > 0 && pose.field_of_view <= kMaximumFieldOfView;
  return sane ? radians(pose.field_of_view) : 0;
}
// The same as look_of() from the pose on a frame; nullopt without one.
inline std::optional<motion::PanTilt> look_of(GstBuffer* frame, GstClockTime running_time) {
  const CerberusPose* pose = cerberus_buffer_peek_pose(frame);
  return pose ? look_of(*pose, running_time) : std::nullopt;
}

}  // namespace cerberus::plugin
