// SPDX-License-Identifier: LGPL-2.1-or-later
// A head with a zoom: its helper is a shell that reports a position and then reads to the end of its input.
#include <string>

#include "../support/says.h"
#include "head_rig.h"

namespace {

using namespace head_rig;

std::string head_at(const std::string& zoom) {
  return "watchdog-timeout=0 driver=external head=" + new_head() +
         " command=\"sh -c 'echo ready 1 velocity feedback; echo zoom " + zoom + "; exec cat >/dev/null'\" ";
}

// Poses come five times a second of the clock; the helper's lines when it is ready.
template <typename Says>
CerberusPose wait_for_pose(Rig& rig, Says says) {
  for (;;) {
    for (const CerberusPose& pose : rig.poses())
      if (says(pose)) return pose;
    rig.crank();
  }
}

}  // namespace

GST_START_TEST(what_the_head_sees_goes_with_its_poses) {
  Rig rig("zoom-table=\"0 60; 0.5 20; 1 3.2\" " + head_at("0.5"), Source::live);
  rig.push(frame_with(CERBERUS_FUSION_HOLD, 0));
  const CerberusPose pose = wait_for_pose(rig, [](const CerberusPose& p) { return p.field_of_view > 0; });
  fail_unless(std::fabs(pose.field_of_view - 20) < 1e-6, "%g", pose.field_of_view);
  fail_unless(rig.warnings().empty());
}
GST_END_TEST

GST_START_TEST(a_zoom_of_which_nothing_is_known_is_a_warning) {
  Rig rig(head_at("0.5"), Source::live);
  rig.push(frame_with(CERBERUS_FUSION_HOLD, 0));
  std::string warnings;
  while (warnings.empty()) {
    rig.crank();
    for (const CerberusPose& pose : rig.poses()) fail_unless(pose.field_of_view <= 0);
    warnings = rig.warnings();
  }
  wait_for_pose(rig,
                [](const CerberusPose& p) { return p.field_of_view < 0; });  // not 0, which would be: no zoom
  fail_unless(says(warnings, "has a zoom, and every angle depends on it: set zoom-table"));
  for (int k = 0; k < 20; ++k) rig.crank();
  fail_unless(rig.warnings().empty(), "once");
}
GST_END_TEST

namespace {

std::string refusal_of(const std::string& settings) {
  g_autoptr(GstElement) sink = gst_parse_launch(("pantiltsink " + settings).c_str(), nullptr);
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(sink, bus);
  gst_element_set_state(sink, GST_STATE_PAUSED);
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, GST_CLOCK_TIME_NONE, GST_MESSAGE_ERROR);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  gst_element_set_state(sink, GST_STATE_NULL);
  gst_element_set_bus(sink, nullptr);
  return error->message;
}

}  // namespace

GST_START_TEST(what_cannot_be_is_an_error) {
  const struct {
    std::string settings, words;
  } cases[] = {
      {"zoom-table=wide", "\"wide\" is no zoom table"},
      {"driver=pelco-d device=serial:/dev/null lock-zoom=0",
       "the driver pelco-d keeps no zoom: lock-zoom is for"},
      {"driver=visca device=udp:127.0.0.1:9 lock-zoom=2", "is kept at 0 to 1.92 (lock-zoom), not at 2"},
      {"driver=servo-pwm device=pwmchip0 keep-size=true zoom-table=\"0 60; 1 6\"",
       "the driver servo-pwm moves no zoom: keep-size is for visca"},
      {"keep-size=true", "keep-size needs a zoom-table"},
      {"driver=visca device=udp:127.0.0.1:9 lock-zoom=0 keep-size=true zoom-table=\"0 60; 1 6\"",
       "lock-zoom keeps the zoom that keep-size moves: set one of them"},
      {head_at("0") + " keep-size=true zoom-table=\"0 60; 1 6\"", "has no zoom to move (keep-size)"},
      {"driver=pelco-d device=serial:/dev/null device-options=zoom=0.5", "\"zoom\" is no option of pelco-d"}};
  for (const auto& [settings, words] : cases) {
    std::string error = refusal_of(settings);
    // A helper on a busy machine; the test's own time-out ends it.
    while (error.find("does not answer with `ready") != error.npos) error = refusal_of(settings);
    fail_unless(says(error, words));
  }
}
GST_END_TEST

static Suite* pantiltsink_zoom_suite() {
  Suite* suite = suite_create("pantiltsink with a zoom");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, what_the_head_sees_goes_with_its_poses);
  tcase_add_test(tests, a_zoom_of_which_nothing_is_known_is_a_warning);
  tcase_add_test(tests, what_cannot_be_is_an_error);
  return suite;
}

GST_CHECK_MAIN(pantiltsink_zoom)
