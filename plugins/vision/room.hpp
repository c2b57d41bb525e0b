// SPDX-License-Identifier: LGPL-2.1-or-later
// How the camera stands in the room: the properties that motionregions and motiontrack share.
#pragma once

#include <numbers>

namespace cerberus::plugin {

inline constexpr double kDefaultMountingHeight = 0.8;  // metres, as on the paper's robot (III)
inline constexpr double kMaximumFieldOfView = 179, kMaximumMountingHeight = 100, kMaximumTilt = 90;

inline constexpr char kFieldOfViewBlurb[] =
    "Angle in degrees that the lens sees over the frame's whole width: with it, limits in metres are judged "
    "and bearing "
    "and distance of objects are known; 0 = unknown";
inline constexpr char kMountingHeightBlurb[] =
    "Height in metres of the lens above the floor on which people walk; the camera looks level unless "
    "tilt or a head's pose on the frame says otherwise";
inline constexpr char kTiltBlurb[] =
    "Angle in degrees by which the camera looks up, negative: down; where a head's pose is on the frame, "
    "that counts instead";

constexpr double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}
constexpr double degrees(double radians) {
  return radians * 180 / std::numbers::pi;
}

}  // namespace cerberus::plugin
