// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of patrolsimsrc, and the house that they describe.
#pragma once

#include <cerberus/pir.h>

#include <memory>
#include <span>
#include <string>
#include <variant>

#include "head_wait.hpp"
#include "sensing/pir_model.h"
#include "shared/properties.hpp"
#include "sim/house/house.h"

// Of the pads `video` and `pir`.
#define PATROL_VIDEO_CAPS                                                   \
  "video/x-raw, format = (string) I420, width = (int) [ 16, 4096, 2 ], "    \
  "height = (int) [ 16, 4096, 2 ], framerate = (fraction) [ 1/1, 120/1 ], " \
  "interlace-mode = (string) progressive"
#define PATROL_PIR_CAPS "application/x-pir, format = (string) presence, sensors = (int) [ 1, 16 ]"

namespace cerberus::plugin {

struct PatrolSettings {
  std::string plan;
  int seed = 1;
  int people = sim::HouseSettings{}.people;
  std::string walks, path;
  double speed = sim::HouseSettings{}.speed;
  double yaw_rate = 45;
  double shake = .1;
  int shake_kind = static_cast<int>(sim::ShakeKind::robot);
  double camera_height = sim::HouseSettings{}.camera_height;
  double horizontal_fov = 60;
  guint64 exposure = 10 * GST_MSECOND;
  double noise = sim::Lens{}.noise;
  double start_pan = 0, start_tilt = 0;
  std::string head = "head";
  int lockstep = LOCKSTEP_AUTO;
  guint64 lockstep_timeout = 10 * GST_SECOND;
  std::string pir_bearings = "0,-120,120";
  int pir_preset = 0;                           // 0: none, else 1 + its place in sensing::pir_presets()
  double pir_field_of_view = 0, pir_range = 0;  // 0: the preset's
  std::string camera_name;
  bool inset = false;
};

std::span<const Property<PatrolSettings>> patrol_properties();

// What the stream of PIR readings says of its sensors; else an error for the user.
std::string pir_info(const PatrolSettings& settings, CerberusPirInfo& info);
// What makes readings of the sensors' lines.
sensing::PirOptions pir_options(const PatrolSettings& settings);
// Metres.
double pir_range(const PatrolSettings& settings);
// The house for pictures of a size; else an error for the user.
std::variant<std::unique_ptr<sim::House>, std::string> build_house(const PatrolSettings& settings,
                                                                   const CerberusPirInfo& sensors, int width,
                                                                   int height);

}  // namespace cerberus::plugin
