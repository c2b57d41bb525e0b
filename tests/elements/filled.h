// SPDX-License-Identifier: LGPL-2.1-or-later
// A pose and a decision in which no field has its default.
#pragma once

#include <cmath>

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>

namespace filled {

inline CerberusPose turning() {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  cerberus_pose_set_head(&pose, "left eye");
  pose.pan = -30.5;
  pose.tilt = 4;
  pose.pan_speed = 20;
  pose.tilt_speed = -2;
  pose.pan_acceleration = 10;
  pose.tilt_acceleration = 1;
  pose.valid_from = 2 * GST_SECOND;
  pose.valid_until = 4 * GST_SECOND;
  pose.source = CERBERUS_POSE_MEASURED;
  pose.moving = TRUE;
  pose.settled = FALSE;
  return pose;
}

inline void assert_same(const CerberusPose& a, const CerberusPose& b) {
  fail_unless_equals_string(a.head, b.head);
  fail_unless(a.pan == b.pan && a.tilt == b.tilt && a.pan_speed == b.pan_speed &&
              a.tilt_speed == b.tilt_speed);
  fail_unless(a.pan_acceleration == b.pan_acceleration && a.tilt_acceleration == b.tilt_acceleration);
  fail_unless_equals_uint64(a.valid_from, b.valid_from);
  fail_unless_equals_uint64(a.valid_until, b.valid_until);
  fail_unless_equals_int(a.source, b.source);
  fail_unless_equals_int(a.moving, b.moving);
  fail_unless_equals_int(a.settled, b.settled);
}

inline CerberusFusion searching() {
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.rule = 3;
  fusion.rule_name = "overlap";
  fusion.action = CERBERUS_FUSION_SEARCH;
  fusion.target = 12;
  fusion.pan = -61.25;
  fusion.sector_from = -90;
  fusion.sector_to = -30;
  fusion.limited = TRUE;
  fusion.camera_found = TRUE;
  fusion.n_sensors = 3;
  fusion.sensors[0] = 1;
  fusion.sensors[1] = 0;
  fusion.sensors[2] = 2;
  fusion.bearings[1] = -120;
  fusion.bearings[2] = 120.5;
  fusion.doubtful = 0b100;
  fusion.immediate = TRUE;
  return fusion;
}

inline bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

inline void assert_same(const CerberusFusion& a, const CerberusFusion& b) {
  fail_unless_equals_int(a.rule, b.rule);
  fail_unless_equals_string(a.rule_name, b.rule_name);
  fail_unless_equals_int(a.action, b.action);
  fail_unless_equals_int(a.target, b.target);
  fail_unless(same_number(a.pan, b.pan) && same_number(a.sector_from, b.sector_from) &&
              same_number(a.sector_to, b.sector_to));
  fail_unless_equals_int(a.limited, b.limited);
  fail_unless_equals_int(a.camera_found, b.camera_found);
  fail_unless_equals_int(a.n_sensors, b.n_sensors);
  for (guint i = 0; i < a.n_sensors; ++i) {
    fail_unless_equals_int(a.sensors[i], b.sensors[i]);
    fail_unless(a.bearings[i] == b.bearings[i]);
  }
  fail_unless_equals_int(a.doubtful, b.doubtful);
  fail_unless_equals_int(a.immediate, b.immediate);
}

}  // namespace filled
