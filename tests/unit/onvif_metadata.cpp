// SPDX-License-Identifier: LGPL-2.1-or-later
// Documents are written by hand after the schema (metadatastream.xsd) and the specification's coordinates.
#include "publish/onvif_metadata.h"

#include <array>
#include <cmath>
#include <string>

#include "support/allocations.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::publish;
using namespace std::chrono_literals;
using cerberus::tests::assert_text;

namespace {

constexpr char kBegin[] =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<tt:MetadataStream xmlns:tt=\"http://www.onvif.org/ver10/schema\">";
constexpr char kEnd[] = "</tt:MetadataStream>";
constexpr char kFrame[] = "<tt:VideoAnalytics><tt:Frame UtcTime=\"1970-01-01T00:00:01.500000Z\">";
constexpr char kFrameEnd[] = "</tt:Frame></tt:VideoAnalytics>";

// 400 x 200 pixels, one and a half seconds after 1970.
MetadataFrame frame() {
  MetadataFrame frame;
  frame.utc = 1500ms;
  frame.width = 400, frame.height = 200;
  frame.analysed = true;
  return frame;
}

void assert_document(const MetadataFrame& frame, const std::string& content) {
  OnvifMetadata metadata;
  assert_text(std::string(metadata.write(frame)), (kBegin + content + kEnd).c_str());
}

void assert_frame(const MetadataFrame& frame, const std::string& content) {
  assert_document(frame, kFrame + content + kFrameEnd);
}

// Frame pixels 100 to 150 and 50 to 150: half way to the left edge, a quarter; half way up, half way down.
MetadataObject standing_object() {
  MetadataObject object;
  object.id = 7;
  object.x = 100, object.y = 50, object.width = 50, object.height = 100;
  object.confidence = .25;
  object.type = "person-like";
  return object;
}
constexpr char kShape[] =
    "<tt:Appearance><tt:Shape><tt:BoundingBox left=\"-0.5\" top=\"0.5\" right=\"-0.25\" bottom=\"-0.5\"/>"
    "<tt:CenterOfGravity x=\"-0.375\" y=\"0\"/></tt:Shape>"
    "<tt:Class><tt:Type Likelihood=\"0.25\">person-like</tt:Type></tt:Class></tt:Appearance>";

}  // namespace

START_TEST(a_frame_in_which_nothing_was_found_is_empty_and_one_that_was_not_looked_at_is_none) {
  assert_frame(frame(), "");
  MetadataFrame unknown = frame();
  unknown.analysed = false;
  assert_document(unknown, "");
}
END_TEST

START_TEST(boxes_are_in_normalized_coordinates) {
  MetadataFrame in = frame();
  const std::array objects{standing_object()};
  in.objects = objects;
  assert_frame(in, std::string("<tt:Object ObjectId=\"7\">") + kShape + "</tt:Object>");
}
END_TEST

START_TEST(a_box_is_cut_at_the_frame_and_an_untracked_one_has_no_identity) {
  MetadataFrame in = frame();
  std::array objects{standing_object()};
  objects[0].id.reset();
  objects[0].x = -100, objects[0].width = 800, objects[0].y = 150;
  in.objects = objects;
  assert_frame(in,
               "<tt:Object><tt:Appearance><tt:Shape><tt:BoundingBox left=\"-1\" top=\"-0.5\" right=\"1\" "
               "bottom=\"-1\"/><tt:CenterOfGravity x=\"0.5\" y=\"-1\"/></tt:Shape><tt:Class><tt:Type "
               "Likelihood=\"0.25\">person-like</tt:Type></tt:Class></tt:Appearance></tt:Object>");
}
END_TEST

// 90 degrees over 400 pixels: a focal length of 200. 30 to the left and 40 up are 50 pixels a second, at 4 metres 1 m/s,
// atan(40 / 30) = 53.13 degrees up.
START_TEST(speed_is_in_metres_where_the_distance_is_known) {
  MetadataFrame in = frame();
  std::array objects{standing_object()};
  objects[0].vx = -30, objects[0].vy = -40;
  in.objects = objects;
  const std::string direction = "<tt:Direction pitch=\"53.13\" yaw=\"180\"/></tt:Behaviour></tt:Object>";
  const std::string begin = std::string("<tt:Object ObjectId=\"7\">") + kShape + "<tt:Behaviour>";
  assert_frame(in, begin + direction);
  in.field_of_view = 90;
  assert_frame(in, begin + direction);
  objects[0].distance = 4;
  assert_frame(in, begin + "<tt:Speed>1</tt:Speed>" + direction);
}
END_TEST

START_TEST(what_has_stopped_is_idle_and_wrong_numbers_are_left_out) {
  MetadataFrame in = frame();
  std::array objects{standing_object()};
  objects[0].stands = true;
  objects[0].confidence = std::nan("");
  objects[0].vx = std::numeric_limits<double>::infinity();
  in.objects = objects;
  std::string shape = kShape;
  shape.erase(shape.find(" Likelihood=\"0.25\""), 18);
  assert_frame(in,
               "<tt:Object ObjectId=\"7\">" + shape + "<tt:Behaviour><tt:Idle/></tt:Behaviour></tt:Object>");
}
END_TEST

// 90 degrees over 400 x 200 pixels: 2 atan(tan(45) / 2) = 53.13 degrees high.
START_TEST(the_status_of_a_head_stands_in_the_frame_or_alone) {
  MetadataFrame in = frame();
  in.field_of_view = 90;
  in.head.emplace();
  in.head->pan = -12.346, in.head->tilt = 3;
  in.head->moves = true;
  const std::string status =
      "<tt:PTZStatus><tt:Position><tt:PanTilt x=\"-12.35\" y=\"3\" "
      "space=\"http://www.onvif.org/ver10/tptz/PanTiltSpaces/SphericalPositionSpaceDegrees\"/></tt:Position>"
      "<tt:MoveStatus><tt:PanTilt>MOVING</tt:PanTilt></tt:MoveStatus><tt:UtcTime>1970-01-01T00:00:01.500000Z"
      "</tt:UtcTime><tt:FieldOfView hfov=\"90\" vfov=\"53.13\"/></tt:PTZStatus>";
  assert_frame(in, status);
  in.analysed = false;
  assert_document(in, "<tt:PTZ>" + status + "</tt:PTZ>");
}
END_TEST

START_TEST(a_head_whose_place_is_unknown_has_no_position) {
  MetadataFrame in = frame();
  in.head.emplace();
  assert_frame(in,
               "<tt:PTZStatus><tt:MoveStatus><tt:PanTilt>UNKNOWN</tt:PanTilt></tt:MoveStatus>"
               "<tt:UtcTime>1970-01-01T00:00:01.500000Z</tt:UtcTime></tt:PTZStatus>");
}
END_TEST

START_TEST(each_sensor_that_is_valid_is_sensor_data) {
  MetadataFrame in = frame();
  in.analysed = false;
  const std::array<std::optional<bool>, 3> sensors{false, std::nullopt, true};
  in.sensors = sensors;
  const auto data = [](const char* number, const char* value) {
    return std::string("<tt:SensorData UtcTime=\"1970-01-01T00:00:01.500000Z\" SensorID=\"pir_") + number +
           "\"><tt:Type>PIR</tt:Type><tt:Value>" + value + "</tt:Value></tt:SensorData>";
  };
  assert_document(in, data("0", "0") + data("2", "1"));
}
END_TEST

START_TEST(documents_of_a_stream_need_no_new_memory) {
  MetadataFrame in = frame();
  const std::array objects{standing_object(), standing_object()};
  in.objects = objects;
  OnvifMetadata metadata;
  metadata.write(in);
  const auto before = cerberus::tests::allocations();
  for (int n = 0; n < 100; ++n) metadata.write(in);
  ck_assert_uint_eq(cerberus::tests::allocations() - before, 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "onvif_metadata",
      {a_frame_in_which_nothing_was_found_is_empty_and_one_that_was_not_looked_at_is_none,
       boxes_are_in_normalized_coordinates, a_box_is_cut_at_the_frame_and_an_untracked_one_has_no_identity,
       speed_is_in_metres_where_the_distance_is_known,
       what_has_stopped_is_idle_and_wrong_numbers_are_left_out,
       the_status_of_a_head_stands_in_the_frame_or_alone, a_head_whose_place_is_unknown_has_no_position,
       each_sensor_that_is_valid_is_sensor_data, documents_of_a_stream_need_no_new_memory});
}
