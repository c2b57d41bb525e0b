// SPDX-License-Identifier: LGPL-2.1-or-later
#include "recorder_settings.hpp"

#include "record/file_names.h"
#include "shared/camera_mount.hpp"

namespace cerberus::plugin {

namespace {

using Settings = RecorderSettings;
constexpr double kMostMebibytes = 1 << 30;  // a pebibyte

GType container_type() {
  static const GEnumValue values[] = {
      {CONTAINER_AUTO, "MP4 where it takes every track, else Matroska", "auto"},
      {CONTAINER_MP4, "MP4 (Matroska for JPEG)", "mp4"},
      {CONTAINER_MATROSKA, "Matroska", "matroska"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusRecordContainer", values);
  return type;
}

const Property<Settings> kProperties[] = {
    property("location", &Settings::location, "Folder of the recordings; it must exist and be writable")
        .read_at_start(),
    property("file-name", &Settings::file_name,
             "Names of the files below `location`, without the ending: conversions of strftime, "
             "{camera}, {event}, "
             "{part}; slashes make folders")
        .read_at_start(),
    property("camera-name", &Settings::camera_name, kCameraNameBlurb),
    property("pre-roll", &Settings::pre_roll,
             "Nanoseconds before the first trigger that are recorded at least; the whole GOP in addition"),
    property("post-roll", &Settings::post_roll, "Nanoseconds that are recorded after the last trigger"),
    property("join", &Settings::join,
             "A trigger that comes so many nanoseconds after the end of an event continues it"),
    property("longest-file", &Settings::longest_file,
             "Nanoseconds after which a long event goes on in another file, at a keyframe; 0 = never"),
    property("container", &Settings::container, container_type, "Container of the files"),
    property("most-memory", &Settings::most_memory, 1, 1 << 16,
             "MiB of encoded video and audio that the ring of the pre-roll may hold"),
    property("trigger-track", &Settings::trigger_track,
             "An object with a track that moves begins an event and keeps it going"),
    property("trigger-fusion", &Settings::trigger_fusion,
             "A fusion action other than `zero` and `hold` begins an event and keeps it going"),
    property("trigger-pir", &Settings::trigger_pir,
             "A PIR sensor that detects motion begins an event and keeps it going"),
    property(
        "trigger-zones", &Settings::trigger_zones,
        "Where a track triggers: polygons as in `zones` of motiondetect; the middle of the lower edge of "
        "the track's box counts; empty = everywhere"),
    property(
        "horizontal-fov", &Settings::field_of_view, 0, kMaximumFieldOfView,
        "Angle in degrees that the lens sees over the analysed frame's whole width, for trigger-zones in "
        "degrees of the world; 0 = unknown"),
    property("json-lines", &Settings::json_lines,
             "Write what was found in each frame of a file as JSON lines beside it"),
    property("picture", &Settings::picture,
             "Write a JPEG of the best moment beside each file (of the pad `analysis`, or of a JPEG stream)"),
    property("index", &Settings::index,
             "SQLite database with a row for each file, relative to `location`; empty = no index and no "
             "retention")
        .read_at_start(),
    property("retention-age", &Settings::retention_age,
             "Nanoseconds after its end at which a recording is deleted unless it is kept; 0 = never"),
    property("retention-size", &Settings::retention_size, 0, kMostMebibytes,
             "MiB that all recordings of the index may take; the oldest are deleted; 0 = no limit"),
    property("retention-free", &Settings::retention_free, 0, kMostMebibytes,
             "MiB that are to be free on the disk; the oldest recordings are deleted; 0 = no limit"),
    property(
        "stop-timeout", &Settings::stop_timeout,
        "Nanoseconds for which the element's stop waits for the disk at most; files that are not complete "
        "then are reported as failed, and stay as far as they are written. A start waits as long, but no "
        "less than 2 s and no longer than 5 s, and goes on"),
};

std::uint64_t mebibytes(int count) {
  return static_cast<std::uint64_t>(count) << 20;
}

}  // namespace

std::span<const Property<RecorderSettings>> recorder_properties() {
  return kProperties;
}

record::EventRecorder::Settings event_settings(const RecorderSettings& settings) {
  record::EventRecorder::Settings to;
  to.pre_roll = time_of(settings.pre_roll);
  to.cycle.post_roll = time_of(settings.post_roll);
  to.cycle.join = time_of(settings.join);
  to.longest_file = time_of(settings.longest_file);
  to.most_bytes = mebibytes(settings.most_memory);
  return to;
}

Files::Settings file_settings(const RecorderSettings& settings) {
  return {settings.file_name, settings.camera_name, settings.container != CONTAINER_MATROSKA,
          settings.container != CONTAINER_MP4};
}

record::Archive::Settings archive_settings(const RecorderSettings& settings) {
  return {settings.location,
          settings.index,
          {time_of(settings.retention_age), mebibytes(settings.retention_size),
           mebibytes(settings.retention_free)}};
}

std::optional<SettingsFault> settings_fault(const RecorderSettings& settings) {
  using Kind = SettingsFault::Kind;
  if (const std::string fault = record::name_pattern_fault(settings.file_name); !fault.empty())
    return SettingsFault{Kind::settings, "The pattern " + record::in_quotes(settings.file_name) +
                                             " of \"file-name\" is refused: " + fault + "."};
  if (const std::string fault = record::TriggerZones().parse(settings.trigger_zones); !fault.empty())
    return SettingsFault{Kind::settings, "trigger-" + fault};
  for (const char* name : {"mp4mux", "matroskamux", "filesink", "appsrc"}) {
    g_autoptr(GstElementFactory) factory = gst_element_factory_find(name);
    if (!factory)
      return SettingsFault{Kind::missing_element,
                           "GStreamer's element " + record::in_quotes(name) +
                               " is missing; Debian has it in gstreamer1.0-plugins-good or -base."};
  }
  return std::nullopt;
}

}  // namespace cerberus::plugin
