// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads from frames, messages and events whether something happened that an event is recorded for.
#pragma once

#include <gst/gst.h>

#include <optional>
#include <string>

#include "record/trigger_zones.h"

namespace cerberus::plugin {

struct TriggerSettings {
  bool track = true, fusion = false, pir = false;
  record::TriggerZones zones;  // of tracks
  vision::Size frame;          // of the frames whose pixels the tracks are in; zero: not known
  std::optional<vision::CameraOrientation> camera;  // at the last of them; none: not known
};

struct Trigger {
  enum class Kind {
    moment,    // an event begins or goes on
    carry_on,  // an event goes on, but none begins: an object that stands
    hold,      // of motion: an event begins and lasts until `release`
    release,
  };
  Kind kind = Kind::moment;
  std::string reason;
};

// Returns the orientation of the camera by the pose on a frame. field_of_view: degrees, where the head reports no
// zoom; 0: not known.
std::optional<vision::CameraOrientation> camera_of(GstBuffer* buffer, GstClockTime running_time,
                                                   vision::Size frame, double field_of_view);
// Of what the elements upstream attached to a frame.
std::optional<Trigger> trigger_of(GstBuffer* buffer, const TriggerSettings& settings);
// Of a message of the library: motion that starts and ends; tracks, decisions and sensors as set. `time` becomes the
// message's running time; GST_CLOCK_TIME_NONE: it has none.
std::optional<Trigger> trigger_of(GstMessage* message, const TriggerSettings& settings, GstClockTime& time);
// Of an event: a decision of the fusion between two frames.
std::optional<Trigger> trigger_of(GstEvent* event, const TriggerSettings& settings);

}  // namespace cerberus::plugin
