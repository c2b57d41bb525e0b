// SPDX-License-Identifier: LGPL-2.1-or-later
// Poses, PIR caps and fusion decisions: in events, caps, metas and messages, there and back.
#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include "support.h"

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr char kPaper[] =
    "application/x-pir,format=presence,sensors=3,bearings=<0.0,-120.0,120.0>,field-of-view=120.0";

CerberusPose turning() {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  cerberus_pose_set_head(&pose, "left eye");
  pose.pan = -30.5;
  pose.tilt = 4;
  pose.pan_speed = 20;
  pose.tilt_speed = -2;
  pose.pan_acceleration = 10;
  pose.tilt_acceleration = 1;
  pose.valid_from = 2 * GST_SECOND;
  pose.valid_until = 4 * GST_SECOND;
  pose.source = CERBERUS_POSE_MEASURED;
  pose.moving = TRUE;
  pose.settled = FALSE;
  return pose;
}

void assert_same(const CerberusPose& a, const CerberusPose& b) {
  fail_unless_equals_string(a.head, b.head);
  fail_unless(a.pan == b.pan && a.tilt == b.tilt && a.pan_speed == b.pan_speed &&
              a.tilt_speed == b.tilt_speed);
  fail_unless(a.pan_acceleration == b.pan_acceleration && a.tilt_acceleration == b.tilt_acceleration);
  fail_unless_equals_uint64(a.valid_from, b.valid_from);
  fail_unless_equals_uint64(a.valid_until, b.valid_until);
  fail_unless_equals_int(a.source, b.source);
  fail_unless_equals_int(a.moving, b.moving);
  fail_unless_equals_int(a.settled, b.settled);
}

CerberusFusion searching() {
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.rule = 3;
  fusion.rule_name = "overlap";
  fusion.action = CERBERUS_FUSION_SEARCH;
  fusion.target = 12;
  fusion.pan = -61.25;
  fusion.sector_from = -90;
  fusion.sector_to = -30;
  fusion.limited = TRUE;
  fusion.camera_found = TRUE;
  fusion.n_sensors = 3;
  fusion.sensors[0] = 1;
  fusion.sensors[1] = 0;
  fusion.sensors[2] = 2;
  fusion.doubtful = 0b100;
  return fusion;
}

bool same_number(double a, double b) {
  return a == b || (std::isnan(a) && std::isnan(b));
}

void assert_same(const CerberusFusion& a, const CerberusFusion& b) {
  fail_unless_equals_int(a.rule, b.rule);
  fail_unless_equals_string(a.rule_name, b.rule_name);
  fail_unless_equals_int(a.action, b.action);
  fail_unless_equals_int(a.target, b.target);
  fail_unless(same_number(a.pan, b.pan) && same_number(a.sector_from, b.sector_from) &&
              same_number(a.sector_to, b.sector_to));
  fail_unless_equals_int(a.limited, b.limited);
  fail_unless_equals_int(a.camera_found, b.camera_found);
  fail_unless_equals_int(a.n_sensors, b.n_sensors);
  for (guint i = 0; i < a.n_sensors; ++i) fail_unless_equals_int(a.sensors[i], b.sensors[i]);
  fail_unless_equals_int(a.doubtful, b.doubtful);
}

// What reaches a sink behind these elements.
GstBuffer* pass(const char* launch, const char* out_caps, GstBuffer* frame) {
  GstHarness* h = gst_harness_new_parse(launch);
  gst_harness_set_src_caps_str(h, "video/x-raw,format=I420,framerate=25/1,width=64,height=48");
  if (out_caps) gst_harness_set_sink_caps_str(h, out_caps);
  fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
  GstBuffer* out = gst_harness_pull(h);
  gst_harness_teardown(h);
  return out;
}

}  // namespace

START_TEST(a_new_pose_looks_straight_ahead_for_ever) {
  g_autoptr(CerberusPose) pose = cerberus_pose_new();
  fail_unless_equals_string(pose->head, "head");
  fail_unless(pose->pan == 0 && pose->tilt == 0 && pose->pan_speed == 0 && pose->pan_acceleration == 0);
  fail_unless_equals_uint64(pose->valid_from, 0);
  fail_unless_equals_uint64(pose->valid_until, GST_CLOCK_TIME_NONE);
  fail_unless(pose->settled && !pose->moving && pose->source == CERBERUS_POSE_COMMANDED);
  g_autoptr(CerberusPose) copy = cerberus_pose_copy(pose);
  fail_unless(copy != pose);
  assert_same(*copy, *pose);
}
END_TEST

// By hand: -30.5 + 20 t + 5 t^2 and 4 - 2 t + t^2 / 2 at t = 1 and 2, held outside the span from 2 s to 4 s.
START_TEST(a_pose_is_evaluated_within_its_span_and_held_outside) {
  const CerberusPose pose = turning();
  const struct {
    GstClockTime time;
    double pan, tilt;
    bool certain;
  } cases[] = {{2 * GST_SECOND, -30.5, 4, true},      {3 * GST_SECOND, -5.5, 2.5, true},
               {4 * GST_SECOND, 29.5, 2, true},       {0, -30.5, 4, false},
               {2 * GST_SECOND - 1, -30.5, 4, false}, {4 * GST_SECOND + 1, 29.5, 2, false},
               {GST_CLOCK_TIME_NONE, -30.5, 4, false}};
  for (const auto& c : cases) {
    double pan = 0, tilt = 0;
    fail_unless_equals_int(cerberus_pose_evaluate(&pose, c.time, &pan, &tilt), c.certain);
    fail_unless(std::abs(pan - c.pan) < 1e-9 && std::abs(tilt - c.tilt) < 1e-9, "%g %g", pan, tilt);
  }
  CerberusPose open = turning();
  open.valid_until = GST_CLOCK_TIME_NONE;
  double pan = 0;
  fail_unless(cerberus_pose_evaluate(&open, 6 * GST_SECOND, &pan, nullptr));
  fail_unless(std::abs(pan - (-30.5 + 80 + 80)) < 1e-9);
  fail_unless(cerberus_pose_evaluate(&open, 6 * GST_SECOND, nullptr, nullptr));
}
END_TEST

START_TEST(a_pose_event_says_what_it_was_told) {
  const CerberusPose pose = turning();
  g_autoptr(GstEvent) event = cerberus_event_new_pose(&pose);
  fail_unless_equals_int(GST_EVENT_TYPE(event), GST_EVENT_CUSTOM_UPSTREAM);
  fail_unless(gst_event_has_name(event, CERBERUS_EVENT_POSE));
  g_autoptr(CerberusPose) back = cerberus_event_parse_pose(event);
  fail_unless(back);
  assert_same(*back, pose);
  fail_if(cerberus_event_parse_base(event, nullptr, nullptr));
}
END_TEST

START_TEST(a_pose_event_that_is_not_right_is_no_pose) {
  const auto refused = [](auto change) {
    const CerberusPose pose = turning();
    g_autoptr(GstEvent) event = cerberus_event_new_pose(&pose);
    change(gst_event_writable_structure(event));
    g_autoptr(CerberusPose) parsed = cerberus_event_parse_pose(event);
    return parsed == nullptr;
  };
  fail_if(refused([](GstStructure*) {}));
  for (const char* field :
       {"head", "pan", "tilt", "pan-speed", "tilt-speed", "pan-acceleration", "tilt-acceleration",
        "valid-from", "valid-until", "source", "moving", "settled"}) {
    fail_unless(refused([&](GstStructure* s) { gst_structure_remove_field(s, field); }), "%s missing", field);
    fail_unless(refused([&](GstStructure* s) { gst_structure_set(s, field, G_TYPE_INT, 1, nullptr); }),
                "%s of another type", field);
  }
  for (const double value : {kNan, HUGE_VAL, -HUGE_VAL, 1e300})
    fail_unless(
        refused([&](GstStructure* s) { gst_structure_set(s, "pan", G_TYPE_DOUBLE, value, nullptr); }));
  fail_unless(refused([](GstStructure* s) {
    gst_structure_set(s, "valid-until", G_TYPE_UINT64, guint64{GST_SECOND}, nullptr);  // before it begins
  }));
  fail_unless(refused([](GstStructure* s) {
    gst_structure_set(s, "valid-from", G_TYPE_UINT64, GST_CLOCK_TIME_NONE, nullptr);
  }));
  fail_unless(refused([](GstStructure* s) { gst_structure_set_name(s, "somebody-elses"); }));
}
END_TEST

START_TEST(other_events_are_neither_pose_nor_base) {
  GstEvent* const events[] = {
      gst_event_new_eos(),
      gst_event_new_flush_start(),
      gst_event_new_reconfigure(),
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty(CERBERUS_EVENT_POSE)),
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty(CERBERUS_EVENT_BASE)),
      gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM, gst_structure_new_empty(CERBERUS_EVENT_POSE)),
  };
  for (GstEvent* event : events) {
    fail_if(cerberus_event_parse_pose(event));
    fail_if(cerberus_event_parse_base(event, nullptr, nullptr));
    gst_event_unref(event);
  }
}
END_TEST

START_TEST(a_base_event_says_how_fast_the_body_turns) {
  g_autoptr(GstEvent) event = cerberus_event_new_base(-12.5, 3 * GST_SECOND);
  double rate = 0;
  GstClockTime time = 0;
  fail_unless(cerberus_event_parse_base(event, &rate, &time));
  fail_unless(rate == -12.5);
  fail_unless_equals_uint64(time, 3 * GST_SECOND);
  fail_unless(cerberus_event_parse_base(event, nullptr, nullptr));
  fail_if(cerberus_event_parse_pose(event));
  for (const double wrong : {kNan, HUGE_VAL, 1e300}) {
    g_autoptr(GstEvent) bad = cerberus_event_new_base(wrong, 0);
    fail_if(cerberus_event_parse_base(bad, &rate, &time));
  }
  g_autoptr(GstEvent) never = cerberus_event_new_base(1, GST_CLOCK_TIME_NONE);
  fail_if(cerberus_event_parse_base(never, &rate, &time));
  fail_unless(rate == -12.5 && time == 3 * GST_SECOND);  // nothing was written
}
END_TEST

START_TEST(pose_and_decision_survive_what_is_done_to_the_picture) {
  const struct {
    const char* launch;
    const char* caps;
  } passages[] = {{"identity", nullptr},
                  {"queue", nullptr},
                  {"tee ! queue", nullptr},
                  {"videoconvert", "video/x-raw,format=RGB,framerate=25/1,width=64,height=48"},
                  {"videoscale", "video/x-raw,format=I420,framerate=25/1,width=32,height=24"},
                  {"videocrop left=8", nullptr}};
  for (const auto& p : passages) {
    GstBuffer* frame = gst_buffer_new_allocate(nullptr, 64 * 48 * 3 / 2, nullptr);
    gst_buffer_memset(frame, 0, 128, 64 * 48 * 3 / 2);
    GST_BUFFER_PTS(frame) = 0;
    const CerberusPose pose = turning();
    const CerberusFusion fusion = searching();
    fail_unless(cerberus_buffer_set_pose(frame, &pose) && cerberus_buffer_set_fusion(frame, &fusion));
    g_autoptr(GstBuffer) out = pass(p.launch, p.caps, frame);
    g_autoptr(CerberusPose) got_pose = cerberus_buffer_get_pose(out);
    g_autoptr(CerberusFusion) got_fusion = cerberus_buffer_get_fusion(out);
    fail_unless(got_pose && got_fusion, "lost in %s", p.launch);
    assert_same(*got_pose, pose);
    assert_same(*got_fusion, fusion);
  }
}
END_TEST

START_TEST(a_frame_has_one_pose_and_one_decision_and_the_last_counts) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  fail_if(cerberus_buffer_get_pose(frame) || cerberus_buffer_peek_pose(frame));
  fail_if(cerberus_buffer_get_fusion(frame) || cerberus_buffer_peek_fusion(frame));
  CerberusPose pose = turning();
  CerberusFusion fusion = searching();
  for (int i = 0; i < 3; ++i) {
    pose.pan = fusion.rule = i;
    fail_unless(cerberus_buffer_set_pose(frame, &pose) && cerberus_buffer_set_fusion(frame, &fusion));
  }
  fail_unless_equals_int(gst_buffer_get_n_meta(frame, CERBERUS_POSE_META_API_TYPE), 1);
  fail_unless_equals_int(gst_buffer_get_n_meta(frame, CERBERUS_FUSION_META_API_TYPE), 1);
  fail_unless(cerberus_buffer_peek_pose(frame)->pan == 2 && cerberus_buffer_peek_fusion(frame)->rule == 2);
  {
    g_autoptr(GstBuffer) shared = gst_buffer_ref(frame);
    fail_if(cerberus_buffer_set_pose(frame, &pose) || cerberus_buffer_set_pose(frame, nullptr));
    fail_if(cerberus_buffer_set_fusion(frame, &fusion) || cerberus_buffer_set_fusion(frame, nullptr));
  }
  fail_unless(cerberus_buffer_set_pose(frame, nullptr) && cerberus_buffer_set_fusion(frame, nullptr));
  fail_if(cerberus_buffer_peek_pose(frame) || cerberus_buffer_peek_fusion(frame));
}
END_TEST

START_TEST(pir_caps_say_what_the_sensors_cover) {
  CerberusPirInfo paper;
  cerberus_pir_info_init(&paper);
  g_autoptr(GstCaps) caps = cerberus_pir_info_to_caps(&paper);
  g_autoptr(GstCaps) expected = gst_caps_from_string(kPaper);
  fail_unless(gst_caps_is_equal(caps, expected));
  g_autoptr(GstCaps) all = gst_caps_from_string(CERBERUS_PIR_CAPS);
  fail_unless(gst_caps_is_subset(caps, all));

  CerberusPirInfo info{};
  g_autoptr(GError) error = nullptr;
  fail_unless(cerberus_pir_info_from_caps(&info, caps, &error) && !error);
  fail_unless(info.format == CERBERUS_PIR_PRESENCE && info.sensors == 3 && info.field_of_view == 120);
  fail_unless(info.bearings[0] == 0 && info.bearings[1] == -120 && info.bearings[2] == 120);
  fail_unless_equals_uint64(cerberus_pir_info_buffer_size(&info), 3);
  info.format = CERBERUS_PIR_LEVEL;
  fail_unless_equals_uint64(cerberus_pir_info_buffer_size(&info), 12);

  for (guint count = 1; count <= CERBERUS_PIR_MAX_SENSORS; ++count) {
    CerberusPirInfo many{};
    many.format = CERBERUS_PIR_LEVEL;
    many.sensors = count;
    many.field_of_view = 360;
    for (guint i = 0; i < count; ++i) many.bearings[i] = 10.25 * i - 100;
    g_autoptr(GstCaps) of_many = cerberus_pir_info_to_caps(&many);
    CerberusPirInfo back{};
    fail_unless(cerberus_pir_info_from_caps(&back, of_many, nullptr));
    fail_unless(back.sensors == count && back.format == CERBERUS_PIR_LEVEL && back.field_of_view == 360);
    for (guint i = 0; i < count; ++i) fail_unless(back.bearings[i] == many.bearings[i]);
  }
}
END_TEST

START_TEST(pir_caps_that_are_incomplete_or_absurd_are_refused_in_words) {
  const struct {
    const char* caps;
    const char* why;
  } cases[] = {
      {"video/x-raw", "not application/x-pir"},
      {"application/x-pir", "format"},
      {"application/x-pir,format=smell,sensors=1,bearings=<0.0>,field-of-view=90.0", "format"},
      {"application/x-pir,format=presence", "sensors must be 1 to 16"},
      {"application/x-pir,format=presence,sensors=0,bearings=<>,field-of-view=90.0",
       "sensors must be 1 to 16"},
      {"application/x-pir,format=presence,sensors=17,field-of-view=90.0", "sensors must be 1 to 16"},
      {"application/x-pir,format=presence,sensors=2,field-of-view=90.0", "bearings"},
      {"application/x-pir,format=presence,sensors=2,bearings=<0.0>,field-of-view=90.0", "bearings"},
      {"application/x-pir,format=presence,sensors=1,bearings=<(int)0>,field-of-view=90.0", "type double"},
      {"application/x-pir,format=presence,sensors=1,bearings=<0.0>", "field-of-view"},
      {"application/x-pir,format=presence,sensors=1,bearings=<0.0>,field-of-view=0.0", "field-of-view"},
      {"application/x-pir,format=presence,sensors=1,bearings=<0.0>,field-of-view=361.0", "field-of-view"},
      {"application/x-pir,format=presence,sensors=[1,3],bearings=<0.0>,field-of-view=90.0",
       "application/x-pir"},
  };
  for (const auto& c : cases) {
    g_autoptr(GstCaps) caps = gst_caps_from_string(c.caps);
    g_autoptr(GError) error = nullptr;
    CerberusPirInfo info;
    cerberus_pir_info_init(&info);
    fail_if(cerberus_pir_info_from_caps(&info, caps, &error), "%s was accepted", c.caps);
    fail_unless(error && strstr(error->message, c.why), "%s: %s", c.caps,
                error ? error->message : "no reason");
    fail_unless_equals_int(info.sensors, 3);  // nothing was written
    fail_if(cerberus_pir_info_from_caps(&info, caps, nullptr));
  }
  CerberusPirInfo wrong;
  cerberus_pir_info_init(&wrong);
  wrong.bearings[1] = kNan;
  fail_if(cerberus_pir_info_to_caps(&wrong));
  cerberus_pir_info_init(&wrong);
  wrong.sensors = 17;
  fail_if(cerberus_pir_info_to_caps(&wrong));
}
END_TEST

START_TEST(a_pir_message_tells_every_reading) {
  CerberusPirInfo info;
  cerberus_pir_info_init(&info);
  const guint8 readings[] = {1, 0, 2};
  g_autoptr(GstMessage) message = cerberus_message_new_pir(nullptr, 5 * GST_SECOND, &info, readings);
  GstClockTime time = 0;
  g_autoptr(GBytes) bytes = cerberus_message_parse_pir(message, &time);
  gsize size = 0;
  const auto* data = static_cast<const guint8*>(g_bytes_get_data(bytes, &size));
  fail_unless_equals_uint64(size, 3);
  fail_unless(data[0] == 1 && data[1] == 0 && data[2] == 2);
  fail_unless_equals_uint64(time, 5 * GST_SECOND);

  g_autoptr(GstMessage) stranger = gst_message_new_element(nullptr, gst_structure_new_empty("something"));
  g_autoptr(GstMessage) empty =
      gst_message_new_element(nullptr, gst_structure_new_empty(CERBERUS_MESSAGE_PIR));
  g_autoptr(GstMessage) eos = gst_message_new_eos(nullptr);
  for (GstMessage* other : {stranger, empty, eos}) {
    fail_if(cerberus_message_parse_pir(other, &time));
    fail_if(cerberus_message_parse_fusion(other, &time));
    fail_if(cerberus_message_parse_pantilt(other, &time, nullptr, nullptr));
  }
  fail_unless_equals_uint64(time, 5 * GST_SECOND);
}
END_TEST

START_TEST(a_fusion_message_tells_the_whole_decision) {
  CerberusFusion fusion = searching();
  for (const bool known : {true, false}) {
    if (!known) {
      cerberus_fusion_init(&fusion);
      fail_unless(std::isnan(fusion.pan) && std::isnan(fusion.sector_from) && std::isnan(fusion.sector_to));
    }
    g_autoptr(GstMessage) message = cerberus_message_new_fusion(nullptr, 7 * GST_SECOND, &fusion);
    GstClockTime time = 0;
    g_autoptr(CerberusFusion) back = cerberus_message_parse_fusion(message, &time);
    fail_unless(back);
    assert_same(*back, fusion);
    fail_unless_equals_uint64(time, 7 * GST_SECOND);
  }
  for (const char* field : {"running-time", "rule", "rule-name", "action", "target", "pan", "sector-from",
                            "sector-to", "limited", "camera-found", "sensors", "doubtful"}) {
    g_autoptr(GstMessage) message = cerberus_message_new_fusion(nullptr, 0, &fusion);
    gst_structure_remove_field(gst_message_writable_structure(message), field);
    fail_if(cerberus_message_parse_fusion(message, nullptr), "without %s", field);
  }
}
END_TEST

START_TEST(actions_have_names) {
  const struct {
    CerberusFusionAction action;
    const char* name;
  } names[] = {{CERBERUS_FUSION_TRACK, "track"},
               {CERBERUS_FUSION_TURN_LEFT, "turn-left"},
               {CERBERUS_FUSION_TURN_RIGHT, "turn-right"},
               {CERBERUS_FUSION_SEARCH, "search"},
               {CERBERUS_FUSION_ZERO, "zero"},
               {CERBERUS_FUSION_HOLD, "hold"}};
  for (const auto& n : names) fail_unless_equals_string(cerberus_fusion_action_get_nick(n.action), n.name);
  const CerberusFusion fusion = searching();
  g_autoptr(GBytes) sensors = cerberus_fusion_get_sensors(&fusion);
  fail_unless_equals_uint64(g_bytes_get_size(sensors), 3);
  g_autoptr(CerberusFusion) copy = cerberus_fusion_copy(&fusion);
  assert_same(*copy, fusion);
}
END_TEST

START_TEST(a_pantilt_message_tells_what_the_head_does) {
  const CerberusPose pose = turning();
  g_autoptr(GstMessage) message =
      cerberus_message_new_pantilt(nullptr, GST_SECOND, "fault", "it does not answer", &pose);
  const GstStructure* s = gst_message_get_structure(message);
  fail_unless(gst_structure_has_name(s, CERBERUS_MESSAGE_PANTILT));
  fail_unless_equals_string(gst_structure_get_string(s, "state"), "fault");
  fail_unless_equals_string(gst_structure_get_string(s, "reason"), "it does not answer");
  fail_unless_equals_string(gst_structure_get_string(s, "head"), "left eye");
  double pan = 0;
  fail_unless(gst_structure_get_double(s, "pan", &pan) && pan == -30.5);

  GstClockTime time = 0;
  g_autofree gchar* state = nullptr;
  g_autofree gchar* reason = nullptr;
  g_autoptr(CerberusPose) back = cerberus_message_parse_pantilt(message, &time, &state, &reason);
  fail_unless(back);
  fail_unless_equals_string(state, "fault");
  fail_unless_equals_string(reason, "it does not answer");
  fail_unless_equals_string(back->head, "left eye");
  fail_unless(back->pan == -30.5 && back->tilt == pose.tilt);
  fail_unless(time == GST_SECOND && back->valid_from == GST_SECOND);
  g_autoptr(CerberusPose) alone = cerberus_message_parse_pantilt(message, nullptr, nullptr, nullptr);
  fail_unless(alone);

  for (const char* field : {"state", "reason", "head", "pan", "tilt", "running-time"}) {
    g_autoptr(GstMessage) lacking = cerberus_message_new_pantilt(nullptr, 0, "stopped", nullptr, &pose);
    g_autoptr(CerberusPose) whole = cerberus_message_parse_pantilt(lacking, nullptr, nullptr, nullptr);
    fail_unless(whole);
    gst_structure_remove_field(gst_message_writable_structure(lacking), field);
    fail_if(cerberus_message_parse_pantilt(lacking, nullptr, nullptr, nullptr), "without %s", field);
  }
}
END_TEST

START_TEST(nothing_crashes_on_null) {
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  g_autoptr(CerberusPose) pose = cerberus_pose_new();
  fail_if(cerberus_pose_copy(nullptr) || cerberus_fusion_copy(nullptr));
  cerberus_pose_free(nullptr);
  cerberus_fusion_free(nullptr);
  EXPECT_CRITICAL(cerberus_pose_init(nullptr));
  EXPECT_CRITICAL(cerberus_pose_set_head(nullptr, "head"));
  EXPECT_CRITICAL(cerberus_pose_set_head(pose, nullptr));
  EXPECT_CRITICAL(cerberus_pose_evaluate(nullptr, 0, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_event_new_pose(nullptr));
  EXPECT_CRITICAL(cerberus_event_parse_pose(nullptr));
  EXPECT_CRITICAL(cerberus_event_parse_base(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_set_pose(nullptr, pose));
  EXPECT_CRITICAL(cerberus_buffer_get_pose(nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_init(nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_to_caps(nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_from_caps(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_buffer_size(nullptr));
  EXPECT_CRITICAL(cerberus_message_new_pir(nullptr, 0, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_message_parse_pir(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_fusion_init(nullptr));
  EXPECT_CRITICAL(cerberus_fusion_get_sensors(nullptr));
  EXPECT_CRITICAL(cerberus_buffer_set_fusion(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_get_fusion(nullptr));
  EXPECT_CRITICAL(cerberus_message_new_fusion(nullptr, 0, nullptr));
  EXPECT_CRITICAL(cerberus_message_parse_fusion(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_message_new_pantilt(nullptr, 0, nullptr, nullptr, pose));
  EXPECT_CRITICAL(cerberus_message_parse_pantilt(nullptr, nullptr, nullptr, nullptr));
}
END_TEST

static Suite* pose_pir_fusion_suite(void) {
  watch_library_log();
  Suite* s = suite_create("pose_pir_fusion");
  TCase* tc = tcase_create("poses");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_new_pose_looks_straight_ahead_for_ever);
  tcase_add_test(tc, a_pose_is_evaluated_within_its_span_and_held_outside);
  tcase_add_test(tc, a_pose_event_says_what_it_was_told);
  tcase_add_test(tc, a_pose_event_that_is_not_right_is_no_pose);
  tcase_add_test(tc, other_events_are_neither_pose_nor_base);
  tcase_add_test(tc, a_base_event_says_how_fast_the_body_turns);
  tc = tcase_create("metas");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, pose_and_decision_survive_what_is_done_to_the_picture);
  tcase_add_test(tc, a_frame_has_one_pose_and_one_decision_and_the_last_counts);
  tc = tcase_create("caps and messages");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, pir_caps_say_what_the_sensors_cover);
  tcase_add_test(tc, pir_caps_that_are_incomplete_or_absurd_are_refused_in_words);
  tcase_add_test(tc, a_pir_message_tells_every_reading);
  tcase_add_test(tc, a_fusion_message_tells_the_whole_decision);
  tcase_add_test(tc, actions_have_names);
  tcase_add_test(tc, a_pantilt_message_tells_what_the_head_does);
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(pose_pir_fusion)
