// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of pirsrc, and what they mean to lib/.
#pragma once

#include <cerberus/pir.h>
#include <gst/gst.h>

#include <bitset>
#include <string>

#include "drivers/sensor/sensor_setup.h"
#include "shared/clock_times.hpp"
#include "shared/properties.hpp"

namespace cerberus::plugin {

struct PirSettings {
  std::string driver = "scripted";
  std::string bearings = "0,-120,120";
  double field_of_view = 120;
  double range = 0;  // metres; 0: not known
  guint64 heartbeat = 100 * GST_MSECOND;
  bool is_live = false;

  int preset = 0;  // 0: none, else 1 + its place in sensing::pir_presets()
  bool active_low = sensing::PirOptions{}.active_low;
  bool retrigger = sensing::PirOptions{}.retrigger;
  guint64 min_pulse = clock_time(sensing::PirOptions{}.min_pulse);
  guint64 debounce = clock_time(sensing::PirOptions{}.debounce);
  guint64 hold = clock_time(sensing::PirOptions{}.hold);
  guint64 block_time = clock_time(sensing::PirOptions{}.block);
  guint64 warm_up = clock_time(sensing::PirOptions{}.warm_up);
  guint64 stuck_after = clock_time(sensing::PirOptions{}.stuck_after);
  int chatter_edges = static_cast<int>(sensing::PirOptions{}.chatter_edges);
  guint64 chatter_window = clock_time(sensing::PirOptions{}.chatter_window);

  std::string chip = drivers::SensorSetup{}.chip;
  std::string lines, leds_red, leds_blue;
  int bias = static_cast<int>(drivers::SensorSetup{}.bias);

  std::string device, codes, device_options, command;

  std::string iio_device = "iio:device0";
  std::string channels = "0,1,2";
  double threshold = sensing::LevelOptions{}.threshold;
  double hysteresis = sensing::LevelOptions{}.hysteresis;
  guint64 sample_interval = clock_time(drivers::SensorSetup{}.interval);

  std::string location, script;
  std::string camera_name;
};

std::span<const Property<PirSettings>> pir_properties();
using PirChosen = std::bitset<64>;  // by property id: what the application set itself

// Sets every property of the preset that the application did not set itself.
void apply_preset(PirSettings& settings, const PirChosen& chosen);
bool is_preset_property(guint id);

// Writes the stream's caps into `info`. Returns an empty text, or an error for the user.
std::string pir_info(const PirSettings& settings, CerberusPirInfo& info);
drivers::SensorSetup sensor_setup(const PirSettings& settings, guint sensors);
sensing::PirOptions pir_options(const PirSettings& settings);

}  // namespace cerberus::plugin
