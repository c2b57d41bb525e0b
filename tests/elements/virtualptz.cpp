// SPDX-License-Identifier: LGPL-2.1-or-later
// The picture and the messages of virtualptz. (Its waiting: virtualptz_lockstep.cpp.)
#include <cmath>
#include <span>
#include <string>
#include <tuple>

#include "ptz_rig.h"

using namespace ptz_rig;

namespace {

double property(const Ptz& ptz, const char* name) {
  gdouble value = 0;
  GstElement* element = gst_harness_find_element(ptz.h.get(), "virtualptz");
  g_object_get(element, name, &value, nullptr);
  gst_object_unref(element);
  return value;
}

}  // namespace

GST_START_TEST(the_window_is_the_middle_of_the_picture_in_every_format) {
  for (const char* format : std::span(kFormats).first(kByteFormatCount)) {
    Ptz ptz(kLine, true, format);
    ptz.frame_shows(0, 80, 60);
  }
}
GST_END_TEST

GST_START_TEST(a_pose_moves_the_window_in_every_format) {
  for (const char* format : std::span(kFormats).first(kByteFormatCount)) {
    Ptz ptz(kLine, true, format);
    ptz.frame_shows(0, 80, 60);
    send(ptz.h.get(), pose(kForty));
    ptz.frame_shows(1, 120, 60);
    send(ptz.h.get(), pose(-kForty));
    ptz.frame_shows(2, 40, 60);
    send(ptz.h.get(), pose(0, kForty));
    ptz.frame_shows(3, 80, 20);
  }
}
GST_END_TEST

GST_START_TEST(the_window_begins_at_its_start_position) {
  Ptz ptz(kLine + "start-pan=8.2132107 start-tilt=-89");
  ptz.frame_shows(0, 120, 120);
}
GST_END_TEST

GST_START_TEST(a_head_that_points_beyond_its_reach_is_warned_of_once) {
  Ptz ptz;
  Bus bus(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  const double pan = property(ptz, "pan-max"), tilt = property(ptz, "tilt-max");
  int number = 0;
  std::string text;
  const auto warnings = [&](double to_pan, double to_tilt) {
    send(ptz.h.get(), pose(to_pan, to_tilt));
    gst_buffer_unref(ptz.through(++number));
    return bus.count(GST_MESSAGE_WARNING, &text);
  };
  fail_unless_equals_int(warnings(pan, 0) + warnings(-pan, tilt) + warnings(0, -tilt - 0.9), 0);
  fail_unless_equals_int(warnings(-31.25, 0), 1);
  fail_unless(text.find("pan -31.25, tilt 0,") != text.npos && text.find("pan-min") != text.npos, "%s",
              text.c_str());
  fail_unless_equals_int(warnings(0, 40), 0);  // it was reported already
}
GST_END_TEST

GST_START_TEST(between_pixels_it_interpolates) {
  // Columns 10 and 20 by turns; by a quarter of a pixel to the right (pan = atan(0.25 / F)) everything is 12.5 or 17.5.
  Ptz ptz(kLine, true, "GRAY8");
  GstBuffer* stripes = frame(ptz.in);
  GstMapInfo map;
  gst_buffer_map(stripes, &map, GST_MAP_WRITE);
  for (gsize i = 0; i < map.size; ++i) map.data[i] = i % 2 ? 20 : 10;
  gst_buffer_unmap(stripes, &map);
  gst_harness_push(ptz.h.get(), gst_buffer_copy_deep(stripes));
  gst_buffer_unref(gst_harness_pull(ptz.h.get()));
  send(ptz.h.get(), pose(std::atan(0.25 / 277.128) * 180 / M_PI));
  GST_BUFFER_PTS(stripes) = 40 * GST_MSECOND;
  gst_harness_push(ptz.h.get(), stripes);
  const Picture seen(ptz.out, gst_harness_pull(ptz.h.get()));
  for (int x = 0; x < kWindowWidth; ++x) fail_unless_equals_int(seen.at(0, x, 7), x % 2 ? 18 : 13);
}
GST_END_TEST

GST_START_TEST(a_moving_pose_is_evaluated_at_the_frames_time) {
  Ptz ptz;
  ptz.frame_shows(0, 80, 60);
  CerberusPose p = pose(0);
  p.pan_speed = kForty / 0.040;
  p.valid_until = 40 * GST_MSECOND;
  p.moving = TRUE;
  send(ptz.h.get(), p);
  ptz.frame_shows(1, 120, 60);
}
GST_END_TEST

GST_START_TEST(poses_are_passed_on_and_only_those_of_the_own_head_count) {
  Ptz ptz;
  ptz.frame_shows(0, 80, 60);
  CerberusPose other = pose(kForty);
  cerberus_pose_set_head(&other, "another");
  send(ptz.h.get(), other);
  gst_harness_push_upstream_event(
      ptz.h.get(),
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                           gst_structure_new(CERBERUS_EVENT_POSE, "pan", G_TYPE_STRING, "x", nullptr)));
  ptz.frame_shows(1, 80, 60);
  send(ptz.h.get(), pose(kForty));
  ptz.frame_shows(2, 120, 60);
  int passed = 0;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(ptz.h.get())) {
    passed += gst_event_has_name(event, CERBERUS_EVENT_POSE);
    gst_event_unref(event);
  }
  fail_unless_equals_int(passed, 3);
}
GST_END_TEST

GST_START_TEST(a_frame_carries_the_pose_it_was_made_with) {
  Ptz ptz;
  GstBuffer* out = ptz.through(0);
  fail_unless_equals_float(cerberus_buffer_peek_pose(out)->pan, 0);
  fail_unless_equals_string(cerberus_buffer_peek_pose(out)->head, "head");
  gst_buffer_unref(out);
  CerberusPose p = pose(80, 3);
  p.source = CERBERUS_POSE_MEASURED;
  send(ptz.h.get(), p);
  out = ptz.through(1);
  const CerberusPose* made = cerberus_buffer_peek_pose(out);
  fail_unless(std::abs(made->pan - 16.102) < 1e-3, "pan %g: the picture ends there", made->pan);
  fail_unless(std::abs(made->tilt - 3) < 1e-6);
  fail_unless_equals_uint64(made->valid_from, 40 * GST_MSECOND);
  fail_unless(made->source == CERBERUS_POSE_MEASURED);
  gst_buffer_unref(out);
}
GST_END_TEST

// Column x has the value x / 2: the window of 160 columns begins at 80; with half of its tangent at 120, in steps of half a
// column.
GST_START_TEST(a_zoom_shows_a_part_of_the_window_and_the_frame_says_so) {
  Ptz ptz(kLine, true, "GRAY8");
  GstBuffer* ramp = frame(ptz.in);
  GstMapInfo map;
  gst_buffer_map(ramp, &map, GST_MAP_WRITE);
  const gsize width = GST_VIDEO_INFO_WIDTH(&ptz.in), stride = GST_VIDEO_INFO_PLANE_STRIDE(&ptz.in, 0);
  for (gsize i = 0; i < map.size; ++i) map.data[i] = static_cast<guint8>(std::min(i % stride, width - 1) / 2);
  gst_buffer_unmap(ramp, &map);
  const auto shows = [&](int number, double field_of_view) {
    CerberusPose p = pose(0);
    p.field_of_view = field_of_view;
    if (number > 0) send(ptz.h.get(), p);
    GstBuffer* next = gst_buffer_copy_deep(ramp);
    GST_BUFFER_PTS(next) = number * 40 * GST_MSECOND;
    gst_harness_push(ptz.h.get(), next);
    GstBuffer* out = gst_harness_pull(ptz.h.get());
    const double said = cerberus_buffer_peek_pose(out)->field_of_view;
    const Picture seen(ptz.out, out);
    return std::tuple(seen.at(0, 0, 60), seen.at(0, kWindowWidth - 1, 60), said);
  };
  const double half = 2 * std::atan(40 / 277.128) * 180 / M_PI;
  const auto is = [](const auto& seen, int first, int last, double said) {
    const auto& [left, right, degrees] = seen;
    fail_unless(std::abs(left - first) <= 1 && std::abs(right - last) <= 1, "%d to %d", left, right);
    fail_unless(std::abs(degrees - said) < 1e-3, "%g", degrees);
  };
  is(shows(0, 0), 40, 119, 0);
  is(shows(1, half), 60, 99, half);
  is(shows(2, 0), 40, 119, 0);
  const double usual = 2 * std::atan(80 / 277.128) * 180 / M_PI;
  is(shows(3, 120), 40, 119, usual);  // wider than the picture
  is(shows(4, -1), 40, 119, -1);      // a zoom of which nothing is known
  gst_buffer_unref(ramp);
}
GST_END_TEST

GST_START_TEST(a_pose_and_regions_of_the_wide_picture_do_not_come_through) {
  Ptz ptz;
  GstBuffer* in = noise(ptz.in, 0);
  const CerberusPose foreign = pose(5, 5);
  cerberus_buffer_set_pose(in, &foreign);
  add(in, region(1, 10, 10, 20, 20));
  gst_harness_push(ptz.h.get(), in);
  GstBuffer* out = gst_harness_pull(ptz.h.get());
  fail_unless_equals_float(cerberus_buffer_peek_pose(out)->pan, 0);
  GPtrArray* regions = cerberus_buffer_get_regions(out);
  fail_unless_equals_int(regions->len, 0);
  g_ptr_array_unref(regions);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(out), 40 * GST_MSECOND);
  gst_buffer_unref(out);
}
GST_END_TEST

// A window does not move quite as a head turns; the difference must not be reported as a turning robot.
GST_START_TEST(its_base_stands_unless_an_upstream_element_reports_it) {
  Ptz ptz;
  GstBuffer* out = ptz.through(0);
  const CerberusBase* base = cerberus_buffer_peek_base(out);
  fail_unless(base && base->source == CERBERUS_BASE_REPORTED && base->yaw_rate == 0);
  gst_buffer_unref(out);
  GstBuffer* in = noise(ptz.in, 1);
  CerberusBase turning;
  cerberus_base_init(&turning);
  turning.yaw_rate = -8;
  cerberus_buffer_set_base(in, &turning);
  send(ptz.h.get(), pose(0, 0));
  gst_harness_push(ptz.h.get(), in);
  out = gst_harness_pull(ptz.h.get());
  base = cerberus_buffer_peek_base(out);
  fail_unless(base && base->source != CERBERUS_BASE_REPORTED && base->yaw_rate == -8);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(it_says_how_far_it_reaches) {
  Ptz ptz;
  gst_buffer_unref(ptz.through(0));
  fail_unless(std::abs(property(ptz, "pan-min") + 16.102) < 1e-3);
  fail_unless(std::abs(property(ptz, "pan-max") - 16.102) < 1e-3);
  fail_unless(std::abs(property(ptz, "tilt-min") + 12.216) < 1e-3);
  fail_unless(std::abs(property(ptz, "tilt-max") - 12.216) < 1e-3);
  fail_unless(std::abs(property(ptz, "window-fov") - 32.204) < 1e-3);
}
GST_END_TEST

GST_START_TEST(downstream_may_choose_the_size) {
  Harness h = harness("virtualptz");
  gst_harness_set_sink_caps_str(h.get(), "video/x-raw,width=100,height=50");
  gst_harness_set_src_caps_str(h.get(), caps_string("GRAY8", kWidth, kHeight).c_str());
  gst_harness_push(h.get(), frame(info_of(caps_string("GRAY8", kWidth, kHeight))));
  GstBuffer* out = gst_harness_pull(h.get());
  fail_unless_equals_uint64(gst_buffer_get_size(out), info_of(caps_string("GRAY8", 100, 50)).size);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(the_picture_may_change_its_size_on_the_way) {
  Ptz ptz;
  ptz.frame_shows(0, 80, 60);
  gst_harness_set_src_caps_str(ptz.h.get(), caps_string("I420", 640, 480).c_str());
  ptz.in = info_of(caps_string("I420", 640, 480));
  ptz.frame_shows(1, 240, 180);
}
GST_END_TEST

GST_START_TEST(what_does_not_fit_is_an_error_that_says_so) {
  for (const auto& [more, expected] :
       {std::pair{"width=321 height=100", "A window of 321 x 100 pixels does not fit"},
        {"width=160 height=120 wide-fov=60 horizontal-fov=61.5",
         " pixels that sees 61.5 degrees does not fit"}}) {
    Harness h = harness((std::string("virtualptz ") + more).c_str());
    Bus bus(h.get());
    const std::string caps = caps_string("GRAY8", kWidth, kHeight);
    gst_harness_set_src_caps_str(h.get(), caps.c_str());
    for (int start = 0; start < 2; ++start) {
      for (int k = 0; k < 2; ++k)
        fail_unless_equals_int(gst_harness_push(h.get(), frame(info_of(caps))), GST_FLOW_NOT_NEGOTIATED);
      std::string text;
      fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR, &text), 1);
      fail_unless(text.find(std::string(expected) + " into the picture of 320 x 240") != text.npos, "%s",
                  text.c_str());
      // A restart is reported again.
      for (const GstState state : {GST_STATE_READY, GST_STATE_PLAYING})
        gst_element_set_state(h.get()->element, state);
      gst_harness_set_src_caps_str(h.get(), caps.c_str());
    }
  }
}
GST_END_TEST

GST_START_TEST(a_buffer_without_its_picture_is_passed_on_as_such) {
  Ptz ptz;
  Bus bus(ptz.h.get());
  for (int number = 0; number < 2; ++number) {
    GstBuffer* stub = noise(ptz.in, number);
    gst_buffer_set_size(stub, 100);
    fail_unless_equals_int(gst_harness_push(ptz.h.get(), stub), GST_FLOW_OK);
    GstBuffer* out = gst_harness_pull(ptz.h.get());
    fail_unless(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_CORRUPTED));
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
  ptz.frame_shows(2, 80, 60);
}
GST_END_TEST

GST_START_TEST(angles_may_change_while_it_runs_as_long_as_they_fit) {
  Ptz ptz;
  Bus bus(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  GstElement* element = gst_harness_find_element(ptz.h.get(), "virtualptz");
  g_object_set(element, "wide-fov", 90.0, nullptr);
  send(ptz.h.get(), pose(std::atan(40 / 160.0) * 180 / M_PI));
  ptz.frame_shows(1, 120, 60);
  g_object_set(element, "horizontal-fov", 100.0, nullptr);
  ptz.frame_shows(2, 120, 60);
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
  gst_object_unref(element);
}
GST_END_TEST

static Suite* virtualptz_suite() {
  watch_library_log();
  Suite* s = suite_create("virtualptz");
  TCase* tc = tcase_create("window");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_window_is_the_middle_of_the_picture_in_every_format);
  tcase_add_test(tc, a_pose_moves_the_window_in_every_format);
  tcase_add_test(tc, the_window_begins_at_its_start_position);
  tcase_add_test(tc, a_head_that_points_beyond_its_reach_is_warned_of_once);
  tcase_add_test(tc, between_pixels_it_interpolates);
  tcase_add_test(tc, a_moving_pose_is_evaluated_at_the_frames_time);
  tcase_add_test(tc, poses_are_passed_on_and_only_those_of_the_own_head_count);
  tcase_add_test(tc, a_frame_carries_the_pose_it_was_made_with);
  tcase_add_test(tc, a_zoom_shows_a_part_of_the_window_and_the_frame_says_so);
  tcase_add_test(tc, a_pose_and_regions_of_the_wide_picture_do_not_come_through);
  tcase_add_test(tc, its_base_stands_unless_an_upstream_element_reports_it);
  tcase_add_test(tc, it_says_how_far_it_reaches);
  tcase_add_test(tc, downstream_may_choose_the_size);
  tcase_add_test(tc, the_picture_may_change_its_size_on_the_way);
  tcase_add_test(tc, what_does_not_fit_is_an_error_that_says_so);
  tcase_add_test(tc, a_buffer_without_its_picture_is_passed_on_as_such);
  tcase_add_test(tc, angles_may_change_while_it_runs_as_long_as_they_fit);
  return s;
}

GST_CHECK_MAIN(virtualptz)
