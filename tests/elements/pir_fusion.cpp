// SPDX-License-Identifier: LGPL-2.1-or-later
// Decisions and poses on frames, PIR caps, messages of sensors and of decisions: there and back.
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <limits>

#include "filled.h"
#include "support.h"

#include <gst/check/gstharness.h>

using filled::assert_same, filled::searching, filled::turning;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr char kPaper[] =
    "application/x-pir,format=presence,sensors=3,bearings=<0.0,-120.0,120.0>,field-of-view=120.0";

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

// Turn or speed may be unknown, but not both.
START_TEST(an_event_of_the_base_says_what_is_known) {
  const auto read = [](double yaw_rate, double speed) {
    CerberusBase base;
    cerberus_base_init(&base);
    base.yaw_rate = yaw_rate;
    base.speed = speed;
    base.valid_from = 7;
    g_autoptr(GstEvent) event = cerberus_event_new_base(&base);
    return cerberus_event_parse_base(event);
  };
  g_autoptr(CerberusBase) both = read(-12.5, .25);
  fail_unless(both && both->yaw_rate == -12.5 && both->speed == .25 && both->valid_from == 7);
  fail_unless(both->source == CERBERUS_BASE_REPORTED);
  g_autoptr(CerberusBase) turn = read(3, kNan);
  fail_unless(turn && turn->yaw_rate == 3 && std::isnan(turn->speed));
  g_autoptr(CerberusBase) drive = read(kNan, -1);
  fail_unless(drive && std::isnan(drive->yaw_rate) && drive->speed == -1);
  fail_if(read(kNan, kNan));
  fail_if(read(kNan, HUGE_VAL));
}
END_TEST

START_TEST(a_pir_message_contains_every_reading) {
  CerberusPir pir;
  cerberus_pir_init(&pir);
  pir.n_sensors = 3;
  pir.sensors[0] = 1;
  pir.sensors[2] = 2;
  pir.bearings[1] = -120;
  pir.doubtful = 4;
  const CerberusStamp stamp = stamp_at(5 * GST_SECOND);
  g_autoptr(GstMessage) message = cerberus_message_new_pir(nullptr, &stamp, &pir);
  g_autoptr(CerberusPir) back = cerberus_message_parse_pir(message);
  fail_unless(back && back->bearings[1] == -120 && back->doubtful == 4);
  g_autoptr(GBytes) bytes = cerberus_pir_get_sensors(back);
  gsize size = 0;
  const auto* data = static_cast<const guint8*>(g_bytes_get_data(bytes, &size));
  fail_unless_equals_uint64(size, 3);
  fail_unless(data[0] == 1 && data[1] == 0 && data[2] == 2);
  fail_unless_equals_uint64(running_time_of(message), 5 * GST_SECOND);

  g_autoptr(GstMessage) foreign = gst_message_new_element(nullptr, gst_structure_new_empty("something"));
  g_autoptr(GstMessage) empty =
      gst_message_new_element(nullptr, gst_structure_new_empty(CERBERUS_MESSAGE_PIR));
  g_autoptr(GstMessage) eos = gst_message_new_eos(nullptr);
  for (GstMessage* other : {foreign, empty, eos}) {
    fail_if(cerberus_message_parse_pir(other));
    fail_if(cerberus_message_parse_fusion(other));
    fail_if(cerberus_message_parse_pantilt(other));
    fail_if(cerberus_message_parse_stamp(other));
  }
}
END_TEST

START_TEST(a_fusion_message_tells_the_whole_decision) {
  CerberusFusion fusion = searching();
  for (const bool known : {true, false}) {
    if (!known) {
      cerberus_fusion_init(&fusion);
      fail_unless(std::isnan(fusion.pan) && std::isnan(fusion.sector_from) && std::isnan(fusion.sector_to));
    }
    const CerberusStamp stamp = stamp_at(7 * GST_SECOND);
    g_autoptr(GstMessage) message = cerberus_message_new_fusion(nullptr, &stamp, &fusion);
    g_autoptr(CerberusFusion) back = cerberus_message_parse_fusion(message);
    fail_unless(back);
    assert_same(*back, fusion);
    fail_unless_equals_uint64(running_time_of(message), 7 * GST_SECOND);
  }
  for (const char* field : {"running-time", "rule", "rule-name", "action", "target", "pan", "sector-from",
                            "sector-to", "limited", "camera-found", "sensors", "bearings", "doubtful"}) {
    g_autoptr(GstMessage) message = cerberus_message_new_fusion(nullptr, nullptr, &fusion);
    gst_structure_remove_field(gst_message_writable_structure(message), field);
    fail_if(cerberus_message_parse_fusion(message), "without %s", field);
  }
  // One that was written before there was the field.
  g_autoptr(GstMessage) old = cerberus_message_new_fusion(nullptr, nullptr, &fusion);
  gst_structure_remove_field(gst_message_writable_structure(old), "immediate");
  g_autoptr(CerberusFusion) back = cerberus_message_parse_fusion(old);
  fail_unless(back && !back->immediate);
}
END_TEST

START_TEST(an_event_between_frames_tells_the_whole_decision_and_when) {
  CerberusFusion fusion = searching();
  fusion.decided = 7 * GST_SECOND;
  for (const char* head : {"eye", "", static_cast<const char*>(nullptr)}) {
    g_autoptr(GstEvent) event = fusion_event(head, fusion);
    fail_unless_equals_int(GST_EVENT_TYPE(event), GST_EVENT_CUSTOM_DOWNSTREAM_OOB);  // no queue holds it up
    g_autoptr(CerberusFusion) back = cerberus_event_parse_fusion(event);
    fail_unless(back);
    assert_same(*back, fusion);
    fail_unless_equals_uint64(back->decided, 7 * GST_SECOND);
    fail_unless_equals_string(back->head, head && *head ? head : nullptr);
  }
  for (const char* field : {"head", "decided", "rule-name", "action", "sensors"}) {
    g_autoptr(GstEvent) event = fusion_event("eye", fusion);
    gst_structure_remove_field(gst_event_writable_structure(event), field);
    fail_if(cerberus_event_parse_fusion(event), "without %s", field);
  }
  g_autoptr(GstEvent) right = fusion_event("eye", fusion);
  g_autoptr(GstEvent) upwards =
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_copy(gst_event_get_structure(right)));
  g_autoptr(GstEvent) eos = gst_event_new_eos();
  fail_if(cerberus_event_parse_fusion(upwards) || cerberus_event_parse_fusion(eos));
  fusion.decided = GST_CLOCK_TIME_NONE;  // its order among decisions would be undefined
  EXPECT_CRITICAL(fusion_event("eye", fusion));
  EXPECT_CRITICAL(cerberus_event_new_fusion(nullptr));
  EXPECT_CRITICAL(cerberus_event_parse_fusion(nullptr));
}
END_TEST

// A C structure, a message and an event hold what an application has put in.
START_TEST(invalid_numbers_in_a_decision_move_no_head) {
  for (const int action : {257, -1, 6}) {  // the first is 1 in a byte
    CerberusFusion fusion = searching();
    std::memcpy(&fusion.action, &action, sizeof action);  // as C would
    fusion.rule_name = nullptr;
    fusion.n_sensors = 400;
    fusion.sensors[2] = 100;
    fusion.bearings[2] = kNan;
    fusion.bearings[3] = -HUGE_VAL;
    fusion.decided = 0;
    g_autoptr(GstBuffer) frame = gst_buffer_new();
    fail_unless(cerberus_buffer_set_fusion(frame, &fusion));
    g_autoptr(GstMessage) message = cerberus_message_new_fusion(nullptr, nullptr, &fusion);
    g_autoptr(GstEvent) event = fusion_event("eye", fusion);
    g_autoptr(CerberusFusion) posted = cerberus_message_parse_fusion(message);
    g_autoptr(CerberusFusion) sent = cerberus_event_parse_fusion(event);
    const CerberusFusion* const all[] = {cerberus_buffer_peek_fusion(frame), posted, sent};
    for (const CerberusFusion* f : all) {
      fail_unless_equals_int(f->action, CERBERUS_FUSION_HOLD);
      fail_unless_equals_string(f->rule_name, "none");
      fail_unless_equals_int(f->n_sensors, CERBERUS_PIR_MAX_SENSORS);
      fail_unless_equals_int(f->sensors[2], 2);
      fail_unless(f->bearings[1] == -120 && f->bearings[2] == 0 && f->bearings[3] == 0);
    }
  }
  const CerberusFusion fusion = searching();
  const auto parsed = [&](const char* field, GType type, auto set, auto value) {
    GstMessage* message = cerberus_message_new_fusion(nullptr, nullptr, &fusion);
    GValue array = G_VALUE_INIT, item = G_VALUE_INIT;
    gst_value_array_init(&array, 3);
    g_value_init(&item, type);
    set(&item, value);
    for (int i = 0; i < 3; ++i) gst_value_array_append_value(&array, &item);
    gst_structure_take_value(gst_message_writable_structure(message), field, &array);
    CerberusFusion* result = cerberus_message_parse_fusion(message);
    gst_message_unref(message);
    return result;
  };
  for (const int reading : {257, -1, 3}) {
    g_autoptr(CerberusFusion) f = parsed("sensors", G_TYPE_INT, g_value_set_int, reading);
    fail_unless_equals_int(f->sensors[0], 2);
  }
  fail_if(parsed("sensors", G_TYPE_DOUBLE, g_value_set_double, 1.0));
  fail_if(parsed("bearings", G_TYPE_INT, g_value_set_int, 1));
  fail_if(parsed("bearings", G_TYPE_DOUBLE, g_value_set_double, kNan));
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

START_TEST(nothing_crashes_on_null) {
  fail_if(cerberus_fusion_copy(nullptr));
  cerberus_fusion_free(nullptr);
  EXPECT_CRITICAL(cerberus_pir_info_init(nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_to_caps(nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_from_caps(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_pir_info_buffer_size(nullptr));
  EXPECT_CRITICAL(cerberus_message_new_pir(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_pir_get_sensors(nullptr));
  EXPECT_CRITICAL(cerberus_message_parse_pir(nullptr));
  EXPECT_CRITICAL(cerberus_fusion_init(nullptr));
  EXPECT_CRITICAL(cerberus_fusion_get_sensors(nullptr));
  EXPECT_CRITICAL(cerberus_buffer_set_fusion(nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_get_fusion(nullptr));
  EXPECT_CRITICAL(cerberus_message_new_fusion(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_message_parse_fusion(nullptr));
}
END_TEST

static Suite* pir_fusion_suite() {
  watch_library_log();
  Suite* s = suite_create("pir_fusion");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, pose_and_decision_survive_what_is_done_to_the_picture);
  tcase_add_test(tc, a_frame_has_one_pose_and_one_decision_and_the_last_counts);
  tcase_add_test(tc, pir_caps_say_what_the_sensors_cover);
  tcase_add_test(tc, pir_caps_that_are_incomplete_or_absurd_are_refused_in_words);
  tcase_add_test(tc, an_event_of_the_base_says_what_is_known);
  tcase_add_test(tc, a_pir_message_contains_every_reading);
  tcase_add_test(tc, a_fusion_message_tells_the_whole_decision);
  tcase_add_test(tc, an_event_between_frames_tells_the_whole_decision_and_when);
  tcase_add_test(tc, invalid_numbers_in_a_decision_move_no_head);
  tcase_add_test(tc, actions_have_names);
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(pir_fusion)
