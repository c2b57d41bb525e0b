// SPDX-License-Identifier: LGPL-2.1-or-later
// The velocity of an axis whose camera reports its position late: slower near a limit, and towards an angle where the camera
// refuses to go there by itself.
#pragma once

#include <optional>

#include "motion/profile.h"

namespace cerberus::drivers::onvif {

struct ApproachParameters {
  double limit_horizon =
      0.4;  // seconds before a limit in which a velocity falls; derived: two position inquiries
  double position_gain = 2;  // 1/s: velocity for each degree to an angle; derived: settles in some inquiries
  double arrived = 0.5;      // degrees from an angle or a limit, where the axis stops
};

// Degrees a second. at: where the axis is now, in degrees; nothing: unknown. needs_position: an axis of unknown position
// stands; else it obeys velocities, which brake before the limits by themselves.
double approach(const motion::AxisCommand& command, const motion::AxisLimits& limits,
                std::optional<double> at, bool needs_position, const ApproachParameters& parameters = {});

}  // namespace cerberus::drivers::onvif
