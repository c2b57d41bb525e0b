// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of pantiltsink, and their conversion for lib/.
#pragma once

#include <span>
#include <string>

#include "control/law.h"
#include "drivers/head/head.h"
#include "fusion/fuser.h"
#include "shared/properties.hpp"

namespace cerberus::plugin {

struct HeadSettings {
  std::string driver = "simulated";
  std::string head = "head";
  std::string camera_name;
  std::string script;
  std::string device, device_options, command, calibration, base_gyro, zoom_table;
  double lock_zoom = -1;
  bool keep_size = false;
  double base_turn = 0;
  guint64 helper_timeout = 500 * GST_MSECOND;
  double horizontal_fov = 60;
  double pan_min = -170, pan_max = 170, tilt_min = -45, tilt_max = 45;
  double start_pan = 0, start_tilt = 0;
  double turn_speed = 40, max_speed = 90, max_acceleration = 600;
  int response = static_cast<int>(control::Response::normal);
  guint64 latency = 60 * GST_MSECOND;
  double step_size = 0, backlash = 0, noise = 0;
  int seed = 1;
  int target = static_cast<int>(fusion::TargetChoice::nearest);
  guint64 return_delay = 5 * GST_SECOND;
  guint64 hold_stopped = 30 * GST_SECOND;
  guint64 watchdog_timeout = 500 * GST_MSECOND, manual_timeout = 0;
};

std::span<const Property<HeadSettings>> head_properties();

motion::Limits head_limits(const HeadSettings& settings);
// The properties that head_limits() reads.
void copy_limits(const HeadSettings& from, HeadSettings& to);
// Passwords in `device` and `device-options` become asterisks: properties are shown in graphs and logs.
void hide_passwords(HeadSettings& settings);
control::LawOptions law_options(const HeadSettings& settings);
// Of the decisions without pirfusion.
fusion::FuserOptions fuser_options(const HeadSettings& settings);
drivers::HeadSetup head_setup(const HeadSettings& settings);

}  // namespace cerberus::plugin
