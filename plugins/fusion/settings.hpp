// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of pirfusion, and their conversion for the fuser.
#pragma once

#include <string>

#include "fusion/fuser.h"
#include "sensing/levels.h"
#include "shared/clock_times.hpp"
#include "shared/properties.hpp"

namespace cerberus::plugin {

using fusion::Time;

enum Rules { RULES_COMPLETE, RULES_PAPER };

struct Settings {
  int rules = RULES_COMPLETE;
  std::string rules_file;
  int target = static_cast<int>(fusion::FuserOptions{}.choice);
  guint64 return_delay = clock_time(fusion::FuserOptions{}.return_delay);
  guint64 hold_stopped = clock_time(fusion::FuserOptions{}.hold_stopped);
  guint64 camera_hold = clock_time(fusion::FuserOptions{}.camera_hold);
  double hysteresis = 2;
  double horizontal_fov = 60;
  double pan_minimum = -170, pan_maximum = 170;
  guint64 max_wait = 5 * GST_SECOND;
  guint64 lost_after = GST_SECOND;
  double level_threshold = sensing::LevelOptions{}.threshold;
  double level_hysteresis = sensing::LevelOptions{}.hysteresis;
  std::string head = "head";
  std::string camera_name;
};

extern const std::span<const Property<Settings>> kProperties;

// Returns an error text for invalid limits; empty: they are valid.
std::string limits_fault(const Settings& settings);
// `own_table`: a table of the user has priority over `rules`.
fusion::FuserOptions fuser_options(const Settings& settings, bool own_table);

}  // namespace cerberus::plugin
