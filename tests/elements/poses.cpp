// SPDX-License-Identifier: LGPL-2.1-or-later
// Poses and the base's rate: evaluated, in events and in messages, there and back.
#include <cmath>
#include <initializer_list>
#include <limits>

#include "filled.h"
#include "support.h"

using filled::assert_same, filled::turning;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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

START_TEST(a_pose_that_ends_before_it_begins_holds_what_it_began_with) {
  CerberusPose backwards = turning();
  backwards.valid_until = backwards.valid_from - GST_SECOND;
  for (const GstClockTime time :
       {GstClockTime{0}, GstClockTime{2 * GST_SECOND}, GstClockTime{9 * GST_SECOND}, GST_CLOCK_TIME_NONE}) {
    double pan = 0, tilt = 0;
    cerberus_pose_evaluate(&backwards, time, &pan, &tilt);
    fail_unless(std::abs(pan - -30.5) < 1e-9 && std::abs(tilt - 4) < 1e-9, "%g %g", pan, tilt);
  }
}
END_TEST

START_TEST(a_pose_event_contains_the_given_pose) {
  const CerberusPose pose = turning();
  g_autoptr(GstEvent) event = cerberus_event_new_pose(&pose);
  fail_unless_equals_int(GST_EVENT_TYPE(event), GST_EVENT_CUSTOM_UPSTREAM);
  fail_unless(gst_event_has_name(event, CERBERUS_EVENT_POSE));
  g_autoptr(CerberusPose) back = cerberus_event_parse_pose(event);
  fail_unless(back);
  assert_same(*back, pose);
  fail_if(parse_base(event, nullptr, nullptr));
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
    fail_if(parse_base(event, nullptr, nullptr));
    gst_event_unref(event);
  }
}
END_TEST

START_TEST(a_base_event_says_how_fast_the_body_turns) {
  g_autoptr(GstEvent) event = base_event(-12.5, 3 * GST_SECOND);
  double rate = 0;
  GstClockTime time = 0;
  fail_unless(parse_base(event, &rate, &time));
  fail_unless(rate == -12.5);
  fail_unless_equals_uint64(time, 3 * GST_SECOND);
  fail_unless(parse_base(event, nullptr, nullptr));
  fail_if(cerberus_event_parse_pose(event));
  for (const double wrong : {kNan, HUGE_VAL, 1e300}) {
    g_autoptr(GstEvent) bad = base_event(wrong, 0);
    fail_if(parse_base(bad, &rate, &time));
  }
  g_autoptr(GstEvent) never = base_event(1, GST_CLOCK_TIME_NONE);
  fail_if(parse_base(never, &rate, &time));
  fail_unless(rate == -12.5 && time == 3 * GST_SECOND);  // nothing was written
}
END_TEST

START_TEST(a_pantilt_message_contains_the_head_s_state) {
  const CerberusPose pose = turning();
  g_autoptr(CerberusPantilt) pantilt = cerberus_pantilt_new();
  pantilt->state = CERBERUS_PANTILT_FAULT;
  pantilt->reason = g_strdup("it does not answer");
  pantilt->pose = pose;
  const CerberusStamp stamp = stamp_at(GST_SECOND);
  g_autoptr(GstMessage) message = cerberus_message_new_pantilt(nullptr, &stamp, pantilt);
  const GstStructure* s = gst_message_get_structure(message);
  fail_unless(gst_structure_has_name(s, CERBERUS_MESSAGE_PANTILT));
  fail_unless_equals_string(gst_structure_get_string(s, "state"), "fault");
  fail_unless_equals_string(gst_structure_get_string(s, "reason"), "it does not answer");
  fail_unless_equals_string(gst_structure_get_string(s, "head"), "left eye");
  double pan = 0;
  fail_unless(gst_structure_get_double(s, "pan", &pan) && pan == -30.5);

  g_autoptr(CerberusPantilt) back = cerberus_message_parse_pantilt(message);
  fail_unless(back);
  fail_unless_equals_int(back->state, CERBERUS_PANTILT_FAULT);
  fail_unless_equals_string(back->reason, "it does not answer");
  fail_unless_equals_string(back->pose.head, "left eye");
  fail_unless(back->pose.pan == -30.5 && back->pose.tilt == pose.tilt);
  fail_unless_equals_uint64(back->pose.valid_from, GST_SECOND);
  g_autoptr(CerberusPantilt) copy = cerberus_pantilt_copy(back);
  fail_unless(copy->reason != back->reason && g_str_equal(copy->reason, back->reason));

  for (const char* field : {"state", "reason", "head", "pan", "tilt", "running-time"}) {
    g_autoptr(GstMessage) lacking = cerberus_message_new_pantilt(nullptr, nullptr, pantilt);
    g_autoptr(CerberusPantilt) whole = cerberus_message_parse_pantilt(lacking);
    fail_unless(whole);
    gst_structure_remove_field(gst_message_writable_structure(lacking), field);
    fail_if(cerberus_message_parse_pantilt(lacking), "without %s", field);
  }
}
END_TEST

START_TEST(nothing_crashes_on_null) {
  g_autoptr(CerberusPose) pose = cerberus_pose_new();
  fail_if(cerberus_pose_copy(nullptr));
  cerberus_pose_free(nullptr);
  EXPECT_CRITICAL(cerberus_pose_init(nullptr));
  EXPECT_CRITICAL(cerberus_pose_set_head(nullptr, "head"));
  EXPECT_CRITICAL(cerberus_pose_set_head(pose, nullptr));
  EXPECT_CRITICAL(cerberus_pose_evaluate(nullptr, 0, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_event_new_pose(nullptr));
  EXPECT_CRITICAL(cerberus_event_parse_pose(nullptr));
  EXPECT_CRITICAL(parse_base(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_buffer_set_pose(nullptr, pose));
  g_autoptr(GstBuffer) frame = gst_buffer_new();
  pose->head = nullptr;  // consumers compare it with a name
  fail_unless(cerberus_buffer_set_pose(frame, pose));
  fail_unless_equals_string(cerberus_buffer_peek_pose(frame)->head, "head");
  g_autoptr(GstEvent) event = cerberus_event_new_pose(pose);
  g_autoptr(CerberusPose) parsed = cerberus_event_parse_pose(event);
  fail_unless_equals_string(parsed->head, "head");
  g_autoptr(CerberusPantilt) nameless = cerberus_pantilt_new();
  nameless->pose.head = nullptr;
  g_autoptr(GstMessage) message = cerberus_message_new_pantilt(nullptr, nullptr, nameless);
  g_autoptr(CerberusPantilt) posted = cerberus_message_parse_pantilt(message);
  fail_unless_equals_string(posted->pose.head, "head");
  fail_unless_equals_string(posted->reason, "");
  EXPECT_CRITICAL(cerberus_buffer_get_pose(nullptr));
  EXPECT_CRITICAL(cerberus_message_new_pantilt(nullptr, nullptr, nullptr));
  EXPECT_CRITICAL(cerberus_message_parse_pantilt(nullptr));
}
END_TEST

static Suite* poses_suite() {
  watch_library_log();
  Suite* s = suite_create("poses");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_new_pose_looks_straight_ahead_for_ever);
  tcase_add_test(tc, a_pose_is_evaluated_within_its_span_and_held_outside);
  tcase_add_test(tc, a_pose_that_ends_before_it_begins_holds_what_it_began_with);
  tcase_add_test(tc, a_pose_event_contains_the_given_pose);
  tcase_add_test(tc, a_pose_event_that_is_not_right_is_no_pose);
  tcase_add_test(tc, other_events_are_neither_pose_nor_base);
  tcase_add_test(tc, a_base_event_says_how_fast_the_body_turns);
  tcase_add_test(tc, a_pantilt_message_contains_the_head_s_state);
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(poses)
