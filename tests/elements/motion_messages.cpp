// SPDX-License-Identifier: LGPL-2.1-or-later
// Regions in structures and in messages: there and back.
#include "annotated.h"
#include "support.h"

using annotated::assert_same, annotated::at, annotated::walker;

START_TEST(a_structure_holds_everything_but_what_is_unknown) {
  const CerberusRegion region = walker();  // distance is NaN
  g_autoptr(GstStructure) structure = cerberus_region_to_structure(&region);
  fail_if(gst_structure_has_field(structure, "distance"));
  fail_unless(gst_structure_has_field(structure, "bearing"));
  g_autoptr(CerberusRegion) back = cerberus_region_from_structure(structure);
  assert_same(*back, region);
}
END_TEST

START_TEST(a_structure_of_another_element_is_read_with_care) {
  g_autoptr(GstStructure) other = gst_structure_new_empty("cerberus-objects");
  fail_if(cerberus_region_from_structure(other));
  g_autoptr(GstStructure) wrong = gst_structure_new("cerberus-object", "id", G_TYPE_STRING, "five", "x",
                                                    G_TYPE_INT, 3, "state", G_TYPE_STRING, "flying", "age",
                                                    G_TYPE_DOUBLE, 1.0, "width", G_TYPE_DOUBLE, 4.0, nullptr);
  g_autoptr(CerberusRegion) region = cerberus_region_from_structure(wrong);
  g_autoptr(CerberusRegion) expected = cerberus_region_new();
  expected->width = 4;
  assert_same(*region, *expected);
}
END_TEST

START_TEST(a_motion_message_reads_back) {
  g_autoptr(CerberusMotion) motion = cerberus_motion_new();
  CerberusRegion one = walker(), two = walker();
  two.id = 6;
  cerberus_motion_add_region(motion, &one);
  cerberus_motion_add_region(motion, &two);
  g_autoptr(GstElement) source = gst_element_factory_make("identity", "here");
  gst_object_ref_sink(source);
  for (const bool started : {true, false}) {
    motion->state = started ? CERBERUS_MOTION_STARTED : CERBERUS_MOTION_ENDED;
    const CerberusStamp stamp = stamp_at(42);
    g_autoptr(GstMessage) message = cerberus_message_new_motion(GST_OBJECT(source), &stamp, motion);
    fail_unless(GST_MESSAGE_SRC(message) == GST_OBJECT(source));
    fail_unless(cerberus_message_is_motion(message));
    fail_unless_equals_string(gst_structure_get_string(gst_message_get_structure(message), "state"),
                              started ? "started" : "ended");
    g_autoptr(CerberusMotion) back = cerberus_message_parse_motion(message);
    fail_unless(back);
    fail_unless_equals_int(back->state, motion->state);
    fail_unless_equals_uint64(running_time_of(message), 42);
    fail_unless_equals_int(back->regions->len, 2);
    assert_same(at(back->regions, 0), one);
    assert_same(at(back->regions, 1), two);
  }
}
END_TEST

START_TEST(a_motion_message_may_have_no_objects_and_no_source) {
  CerberusMotion ended;
  cerberus_motion_init(&ended);
  ended.state = CERBERUS_MOTION_ENDED;
  g_autoptr(GstMessage) message = cerberus_message_new_motion(nullptr, nullptr, &ended);
  g_autoptr(CerberusMotion) back = cerberus_message_parse_motion(message);
  fail_unless(back && back->state == CERBERUS_MOTION_ENDED);
  fail_unless_equals_uint64(running_time_of(message), GST_CLOCK_TIME_NONE);
  fail_unless_equals_int(back->regions->len, 0);
}
END_TEST

START_TEST(other_messages_are_not_motion) {
  GstMessage* const messages[] = {
      gst_message_new_eos(nullptr),
      gst_message_new_element(nullptr, gst_structure_new_empty("something")),
      gst_message_new_element(nullptr, gst_structure_new_empty("cerberus-motion")),
      gst_message_new_element(
          nullptr, gst_structure_new("cerberus-motion", "state", G_TYPE_STRING, "paused", "running-time",
                                     G_TYPE_UINT64, G_GUINT64_CONSTANT(1), nullptr)),
      gst_message_new_element(nullptr, gst_structure_new("cerberus-motion", "state", G_TYPE_STRING, "started",
                                                         "running-time", G_TYPE_UINT64, G_GUINT64_CONSTANT(1),
                                                         "objects", G_TYPE_INT, 3, nullptr)),
  };
  for (GstMessage* message : messages) {
    fail_if(cerberus_message_parse_motion(message));
    gst_message_unref(message);
  }
}
END_TEST

START_TEST(nothing_crashes_on_null) {
  EXPECT_CRITICAL(cerberus_region_to_structure(nullptr));
  EXPECT_CRITICAL(cerberus_region_from_structure(nullptr));
  EXPECT_CRITICAL(cerberus_message_is_motion(nullptr));
  EXPECT_CRITICAL(cerberus_message_parse_motion(nullptr));
}
END_TEST

static Suite* motion_messages_suite() {
  watch_library_log();
  Suite* s = suite_create("motion_messages");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_structure_holds_everything_but_what_is_unknown);
  tcase_add_test(tc, a_structure_of_another_element_is_read_with_care);
  tcase_add_test(tc, a_motion_message_reads_back);
  tcase_add_test(tc, a_motion_message_may_have_no_objects_and_no_source);
  tcase_add_test(tc, other_messages_are_not_motion);
  tcase_add_test(tc, nothing_crashes_on_null);
  return s;
}

GST_CHECK_MAIN(motion_messages)
