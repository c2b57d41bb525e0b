// SPDX-License-Identifier: LGPL-2.1-or-later
// motion::Pose (radians, no name of a head) from and to the pose of the installed library (degrees).
#pragma once

#include <cerberus/pose.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clock_times.hpp"
#include "motion/pose.h"
#include "sensing/angles.h"

namespace cerberus::plugin {

inline motion::Pose from_c(const CerberusPose& pose) {
  const auto time = [](GstClockTime t) { return t == GST_CLOCK_TIME_NONE ? motion::kNever : time_of(t); };
  return {.from = time(pose.valid_from),
          .until = time(pose.valid_until),
          .pan = {sensing::radians(pose.pan), sensing::radians(pose.pan_speed),
                  sensing::radians(pose.pan_acceleration)},
          .tilt = {sensing::radians(pose.tilt), sensing::radians(pose.tilt_speed),
                   sensing::radians(pose.tilt_acceleration)},
          .settled = pose.settled != FALSE,
          .measured = pose.source == CERBERUS_POSE_MEASURED,
          .field_of_view = pose.field_of_view < 0 ? std::numeric_limits<double>::quiet_NaN()
                                                  : sensing::radians(pose.field_of_view)};
}

inline CerberusPose to_c(const motion::Pose& pose) {
  CerberusPose out;
  cerberus_pose_init(&out);
  out.pan = sensing::degrees(pose.pan.position);
  out.tilt = sensing::degrees(pose.tilt.position);
  out.pan_speed = sensing::degrees(pose.pan.speed);
  out.tilt_speed = sensing::degrees(pose.tilt.speed);
  out.pan_acceleration = sensing::degrees(pose.pan.acceleration);
  out.tilt_acceleration = sensing::degrees(pose.tilt.acceleration);
  out.valid_from = clock_time(std::max(pose.from, motion::Time::zero()));
  out.valid_until = pose.until == motion::kNever ? GST_CLOCK_TIME_NONE : clock_time(pose.until);
  out.source = pose.measured ? CERBERUS_POSE_MEASURED : CERBERUS_POSE_COMMANDED;
  out.moving = pose.moving();
  out.settled = pose.settled;
  out.field_of_view = std::isnan(pose.field_of_view) ? -1 : sensing::degrees(pose.field_of_view);
  return out;
}

}  // namespace cerberus::plugin
