// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of eventrecorder, and their conversion for lib/.
#pragma once

#include <span>
#include <string>

#include "files.hpp"
#include "shared/properties.hpp"
#include "triggers.hpp"

namespace cerberus::plugin {

enum Container { CONTAINER_AUTO, CONTAINER_MP4, CONTAINER_MATROSKA };

struct RecorderSettings {
  std::string location = ".";
  std::string file_name = "%Y-%m-%d/%H-%M-%S_{camera}_{event}";
  std::string camera_name;
  guint64 pre_roll = 5 * GST_SECOND, post_roll = 5 * GST_SECOND, join = 2 * GST_SECOND,
          longest_file = 600 * GST_SECOND;
  int container = CONTAINER_AUTO;
  int most_memory = 256;
  bool trigger_track = true, trigger_fusion = false, trigger_pir = false;
  std::string trigger_zones;
  double field_of_view = 0;
  bool json_lines = true, picture = true;
  std::string index = "recordings.sqlite";
  guint64 retention_age = clock_time(record::Limits{}.age);
  int retention_size = 0, retention_free = 512;
  guint64 stop_timeout = 20 * GST_SECOND;
};

std::span<const Property<RecorderSettings>> recorder_properties();

record::EventRecorder::Settings event_settings(const RecorderSettings& settings);
Files::Settings file_settings(const RecorderSettings& settings);
record::Archive::Settings archive_settings(const RecorderSettings& settings);

// What is wrong with settings that are read at the start, in words for a user and as GStreamer's error domain and code.
struct SettingsFault {
  enum class Kind { settings, missing_element } kind;
  std::string text;
};
std::optional<SettingsFault> settings_fault(const RecorderSettings& settings);

}  // namespace cerberus::plugin
