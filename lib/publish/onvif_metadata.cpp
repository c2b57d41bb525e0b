// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/onvif_metadata.h"

#include <algorithm>
#include <cmath>

#include "sensing/angles.h"
#include "text/numbers.h"
#include "text/utc.h"

namespace cerberus::publish {

namespace {

constexpr std::string_view kDegrees =
    "http://www.onvif.org/ver10/tptz/PanTiltSpaces/SphericalPositionSpaceDegrees";
constexpr int kPlaces = 5;  // decimals of normalized coordinates: a twentieth of a pixel in 8K
constexpr int kAngleDecimals = 2, kShareDecimals = 3, kSpeedDecimals = 2;

// Degrees that the picture's height covers, of a lens without distortion.
double across_height(const MetadataFrame& frame) {
  const double half = std::tan(sensing::radians(frame.field_of_view) / 2) * frame.height / frame.width;
  return sensing::degrees(2 * std::atan(half));
}

}  // namespace

// Writes ` name="value"`.
void OnvifMetadata::number(std::string_view name, double value, int decimals) {
  text_ += ' ';
  text_ += name;
  text_ += "=\"";
  text_ += text::rounded(value, decimals);
  text_ += '"';
}

void OnvifMetadata::status(const MetadataFrame& frame, const MetadataHead& head, std::string_view utc) {
  text("<tt:PTZStatus>");
  const bool known = std::isfinite(head.pan) && std::isfinite(head.tilt);
  if (known) {
    text("<tt:Position><tt:PanTilt");
    number("x", head.pan, kAngleDecimals);
    number("y", head.tilt, kAngleDecimals);
    text(" space=\"");
    text(kDegrees);
    text("\"/></tt:Position>");
  }
  text("<tt:MoveStatus><tt:PanTilt>");
  text(!known ? "UNKNOWN" : head.moves ? "MOVING" : "IDLE");
  text("</tt:PanTilt></tt:MoveStatus><tt:UtcTime>");
  text(utc);
  text("</tt:UtcTime>");
  if (frame.field_of_view > 0) {
    text("<tt:FieldOfView");
    number("hfov", frame.field_of_view, kAngleDecimals);
    number("vfov", across_height(frame), kAngleDecimals);
    text("/>");
  }
  text("</tt:PTZStatus>");
}

// The direction is that in the picture, as if everything moved across the line of sight.
void OnvifMetadata::behaviour(const MetadataFrame& frame, const MetadataObject& object) {
  const double pixels = std::hypot(object.vx, object.vy), speed = std::isfinite(pixels) ? pixels : 0;
  if (!object.stands && speed == 0) return;
  text("<tt:Behaviour>");
  if (object.stands) text("<tt:Idle/>");
  if (speed > 0) {
    if (object.distance > 0 && frame.field_of_view > 0) {
      const double focal = frame.width / 2 / std::tan(sensing::radians(frame.field_of_view) / 2);
      text("<tt:Speed>");
      text(text::rounded(speed * object.distance / focal, kSpeedDecimals));
      text("</tt:Speed>");
    }
    text("<tt:Direction");
    number("pitch", sensing::degrees(std::atan2(-object.vy, std::abs(object.vx))), kAngleDecimals);
    number("yaw", object.vx < 0 ? 180 : 0, 0);
    text("/>");
  }
  text("</tt:Behaviour>");
}

void OnvifMetadata::object(const MetadataFrame& frame, const MetadataObject& object) {
  const auto right = [&](double x) { return std::clamp(2 * x / frame.width - 1, -1.0, 1.0); };
  const auto up = [&](double y) { return std::clamp(1 - 2 * y / frame.height, -1.0, 1.0); };
  text("<tt:Object");
  if (object.id) number("ObjectId", *object.id, 0);
  text("><tt:Appearance><tt:Shape><tt:BoundingBox");
  number("left", right(object.x), kPlaces);
  number("top", up(object.y), kPlaces);
  number("right", right(object.x + object.width), kPlaces);
  number("bottom", up(object.y + object.height), kPlaces);
  text("/><tt:CenterOfGravity");
  number("x", right(object.x + object.width / 2), kPlaces);
  number("y", up(object.y + object.height / 2), kPlaces);
  text("/></tt:Shape><tt:Class><tt:Type");
  if (std::isfinite(object.confidence))
    number("Likelihood", std::clamp(object.confidence, 0.0, 1.0), kShareDecimals);
  text_ += '>';
  text(object.type);
  text("</tt:Type></tt:Class></tt:Appearance>");
  behaviour(frame, object);
  text("</tt:Object>");
}

std::string_view OnvifMetadata::write(const MetadataFrame& frame) {
  const text::Utc utc(frame.utc);
  text_.clear();
  text(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<tt:MetadataStream xmlns:tt=\"http://www.onvif.org/ver10/schema\">");
  if (frame.analysed) {
    text("<tt:VideoAnalytics><tt:Frame UtcTime=\"");
    text(utc);
    text("\">");
    if (frame.head) status(frame, *frame.head, utc);
    for (const MetadataObject& each : frame.objects) object(frame, each);
    text("</tt:Frame></tt:VideoAnalytics>");
  } else if (frame.head) {
    text("<tt:PTZ>");
    status(frame, *frame.head, utc);
    text("</tt:PTZ>");
  }
  for (std::size_t i = 0; i < frame.sensors.size(); ++i) {
    if (!frame.sensors[i]) continue;
    text("<tt:SensorData UtcTime=\"");
    text(utc);
    text("\"");
    text_ += " SensorID=\"pir_";
    text(text::rounded(static_cast<double>(i), 0));
    text("\"><tt:Type>PIR</tt:Type><tt:Value>");
    text(*frame.sensors[i] ? "1" : "0");
    text("</tt:Value></tt:SensorData>");
  }
  text("</tt:MetadataStream>");
  return text_;
}

}  // namespace cerberus::publish
