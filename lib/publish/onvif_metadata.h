// SPDX-License-Identifier: LGPL-2.1-or-later
// What was found in a frame as an ONVIF metadata document (Streaming and Analytics Service Specifications, 24.12; schema
// ver10/schema/metadatastream.xsd).
#pragma once

#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace cerberus::publish {

struct MetadataObject {
  std::optional<std::uint32_t> id;                             // of its track
  double x = 0, y = 0, width = 0, height = 0;                  // frame pixels
  double vx = 0, vy = 0;                                       // frame pixels a second
  double distance = std::numeric_limits<double>::quiet_NaN();  // metres
  double confidence = 0;                                       // 0 to 1
  std::string_view type;                                       // a literal, not escaped
  bool stands = false;
};

struct MetadataHead {
  double pan = std::numeric_limits<double>::quiet_NaN(),
         tilt = pan;  // degrees, right and up; not a number: unknown
  bool moves = false;
};

struct MetadataFrame {
  std::chrono::nanoseconds utc{};  // since 1970
  double width = 1, height = 1;    // pixels
  double field_of_view = 0;        // degrees over the width; 0: unknown
  std::optional<MetadataHead> head;
  bool analysed = false;  // false: what was not looked for is not reported as absent
  std::span<const MetadataObject> objects;
  std::span<const std::optional<bool>> sensors;  // whether each detects; none: it gives no valid value
};

// Writes documents into one reused string: no locale, no allocation in the steady state.
class OnvifMetadata {
 public:
  // Returns the document of a frame, valid until the next call. Boxes are cut at the frame and written in ONVIF's
  // normalized coordinates (-1 to 1, right and up), positions in degrees (SphericalPositionSpaceDegrees), speeds in metres
  // a second across the line of sight, where distance and field of view are known.
  std::string_view write(const MetadataFrame& frame);

 private:
  void status(const MetadataFrame& frame, const MetadataHead& head, std::string_view utc);
  void object(const MetadataFrame& frame, const MetadataObject& object);
  void behaviour(const MetadataFrame& frame, const MetadataObject& object);
  void text(std::string_view text) { text_ += text; }
  void number(std::string_view name, double value, int decimals);

  std::string text_;
};

}  // namespace cerberus::publish
