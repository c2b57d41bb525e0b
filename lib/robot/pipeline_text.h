// SPDX-License-Identifier: LGPL-2.1-or-later
// The GStreamer pipeline of one camera as text. Texts of the user stand in assignments, never in the line, so that no
// character of theirs is parsed.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/settings.h"

namespace cerberus::robot {

// How long rtspsrc holds frames back, for the jitter of a network. Chosen: its own 2 s would make the head as late.
constexpr std::chrono::milliseconds kNetworkLatency{200};

struct Assignment {
  std::string element, property, value;
  std::uint32_t line = 0;  // of the file; 0: the file does not say so itself
};

struct PipelineText {
  std::string line;                     // as gst-launch-1.0 reads it
  std::vector<Assignment> assignments;  // in order, before the pipeline starts
};

// Which parts of a camera the pipeline has; one that failed is left out until it is tried again.
struct Parts {
  bool head = true, recorder = true;
};

// Names in the line: `source` (and `recorded`, the second stream) or `patrol`, `detect`, `fusion`, `sensors`, `head`, `recorder`;
// `mqtt`; the queues `picture-queue`, `record-queue`, `analysis-queue` at which frames may be dropped; the appsinks
// `picture` (JPEG) and `facts` (JSON lines), and those of the RTSP server: kRtspPrefix with `plain`, `annotated` (encoded)
// or `metadata` (ONVIF), each behind a valve of its name with `-valve` where nothing else needs the stream.
PipelineText pipeline_text(const CameraSettings& camera, const SharedSettings& shared, Parts parts);

inline constexpr std::string_view kRtspPrefix = "rtsp-";

// A property whose value differs between two pipelines of one line.
struct PropertyChange {
  std::string element, property;
  std::optional<std::string> value;  // nullopt: its default
};

// The properties that make `after` of `before`. nullopt: their lines differ, so that properties are not enough.
std::optional<std::vector<PropertyChange>> changes(const PipelineText& before, const PipelineText& after);

// What may begin an event while armed: the property and its value. While disarmed all of them are false.
Properties triggers(const RecorderSettings& recorder);

}  // namespace cerberus::robot
