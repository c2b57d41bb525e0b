// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink with a clock: poses by the clock, the watchdog,
// drivers that fail, and every way of asking for what cannot be.
#include <chrono>  // before gst-check, whose macros break standard headers

#include "../support/entries.h"
#include "../support/says.h"
#include "head_rig.h"
#include "promises.h"

namespace {

using namespace head_rig;

// Waits for a pose for which says() is true; the clock stands still.
template <typename Says>
CerberusPose wait_for_pose(Rig& rig, Says says) {
  for (;;) {
    const CerberusPose pose = rig.next_pose();
    if (says(pose)) return pose;
  }
}

GST_START_TEST(at_rest_poses_come_five_times_a_second) {
  Rig rig("watchdog-timeout=0", Source::live);
  rig.next_pose();
  rig.push(frame_with(CERBERUS_FUSION_HOLD, 0));
  rig.crank();
  rig.poses();
  const GstClockTime start = rig.time();
  int poses = 0;
  while (rig.time() < start + GST_SECOND) {
    rig.crank();
    const auto published = rig.poses();
    poses += published.size();
    for (const CerberusPose& pose : published) {
      fail_if(pose.moving);
      fail_unless_equals_uint64(pose.valid_until, GST_CLOCK_TIME_NONE);
    }
  }
  fail_unless_equals_int(poses, 5);
}
GST_END_TEST

GST_START_TEST(a_moving_head_tells_where_it_is_fifty_times_a_second) {
  Rig rig("watchdog-timeout=0 max-speed=40", Source::live);
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, 0));
  // At once: the plan has changed, its first piece ends when the latency has passed.
  wait_for_pose(rig, [](const CerberusPose& pose) { return pose.valid_until == 60 * GST_MSECOND; });
  while (rig.time() < 200 * GST_MSECOND) rig.crank();
  rig.poses();
  const GstClockTime start = rig.time();
  int poses = 0;
  while (rig.time() < start + GST_SECOND) {
    rig.crank();
    for (const CerberusPose& pose : rig.poses()) {
      fail_unless(pose.moving);
      fail_unless(std::fabs(pose.pan_speed - 40) < 1e-9);
      ++poses;
    }
  }
  fail_unless_equals_int(poses, 50);
}
GST_END_TEST

GST_START_TEST(a_piece_that_ends_is_followed_by_the_next_at_that_time) {
  Rig rig("watchdog-timeout=0", Source::live);
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, 0));
  CerberusPose last =
      wait_for_pose(rig, [](const CerberusPose& pose) { return pose.valid_until == 60 * GST_MSECOND; });
  bool accelerated = false;
  for (int k = 0; k < 12; ++k) {
    rig.crank();
    for (const CerberusPose& pose : rig.poses()) {
      fail_unless(pose.valid_from <= last.valid_until);
      if (pose.valid_from == 60 * GST_MSECOND) {
        fail_unless(std::fabs(pose.pan_acceleration - 600) < 1e-6);
        accelerated = true;
      }
      last = pose;
    }
  }
  fail_unless(accelerated);
}
GST_END_TEST

GST_START_TEST(when_frames_stay_away_the_head_stops) {
  Rig rig("watchdog-timeout=300000000 max-speed=40", Source::live);
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, 0));
  wait_for_pose(rig, [](const CerberusPose& pose) { return pose.valid_until == 60 * GST_MSECOND; });
  while (rig.time() < 800 * GST_MSECOND) rig.crank();
  const auto poses = rig.poses();
  fail_if(poses.back().moving);
  // 40 degrees a second from 60 + 33 ms on until the stop of 300 ms is obeyed at 360.
  const double expected = 40 * (0.36 - 0.06 - 1 / 30.0) + 40 * 40 / 1200.0;
  fail_unless(std::fabs(poses.back().pan - expected) < 0.1, "%g %g", poses.back().pan, expected);
  const auto messages = rig.messages();
  fail_unless_equals_string(messages.back().state.c_str(), "stopped");
  fail_unless(messages.back().reason.find("no frame came for 300 ms") != std::string::npos);
  fail_if(messages.back().waits);
  // The next frame is obeyed.
  rig.push(frame_with(CERBERUS_FUSION_TURN_LEFT, 900 * GST_MSECOND));
  const std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "turning");
}
GST_END_TEST

// The clock stands at two hours. A frame of three hours later is one of now; frames of an hour ago move nothing, even
// where they come in a row.
GST_START_TEST(a_single_time_stamp_that_is_far_off_blinds_no_live_head_and_old_frames_move_none) {
  Rig rig("watchdog-timeout=0", Source::live);
  const GstClockTime now = 7200 * GST_SECOND;
  gst_harness_set_time(rig.harness, now);
  for (int k = 10; k > 0; --k) rig.push(frame_with(CERBERUS_FUSION_HOLD, now - k * kFrame));
  rig.messages();
  rig.push(frame_with(CERBERUS_FUSION_HOLD, now + 3 * 3600 * GST_SECOND));
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, now + kFrame));
  fail_unless(rig.states() == "turning");
  for (int k = 0; k < 10; ++k)
    rig.push(frame_with(CERBERUS_FUSION_ZERO, now - 3600 * GST_SECOND + k * kFrame));
  fail_unless(rig.states() == "");
  rig.push(frame_with(CERBERUS_FUSION_HOLD, now + 2 * kFrame));
  fail_unless(rig.states() == "holding");
}
GST_END_TEST

GST_START_TEST(when_frames_stay_away_an_order_is_over) {
  Rig rig("watchdog-timeout=300000000 max-speed=20", Source::live);
  rig.push(frame_with(CERBERUS_FUSION_TURN_LEFT, 0));
  fail_unless(rig.call("move-to", 90, 0));
  while (rig.time() < GST_SECOND) rig.crank();
  const CerberusPose stopped = rig.poses().back();
  fail_unless(!stopped.moving && stopped.pan > 0 && stopped.pan < 20 * 0.4, "%g", stopped.pan);
  auto messages = rig.messages();
  fail_unless_equals_string(messages.back().state.c_str(), "stopped");
  fail_unless_equals_string(messages.back().reason.c_str(), "no frame came for 300 ms");
  fail_unless(messages.back().waits);
  // The head is still in the application's hand.
  rig.push(frame_with(CERBERUS_FUSION_TURN_LEFT, GST_SECOND));
  messages = rig.messages();
  fail_unless_equals_int(messages.size(), 1);
  fail_unless_equals_string(messages[0].state.c_str(), "manual");
  while (rig.time() < 2 * GST_SECOND) rig.crank();
  for (const CerberusPose& pose : rig.poses()) fail_unless(pose.pan == stopped.pan);
  // A manual command that is given after the timeout needs no frames.
  fail_unless(rig.call("move-to", 30, 0));
  while (rig.time() < 5 * GST_SECOND) rig.crank();
  fail_unless(std::fabs(rig.poses().back().pan - 30) < 1e-9);
}
GST_END_TEST

GST_START_TEST(in_pause_a_head_with_a_clock_stands_still) {
  Rig rig("watchdog-timeout=0 max-speed=40", Source::live);
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, 0));
  wait_for_pose(rig, [](const CerberusPose& pose) { return pose.valid_until == 60 * GST_MSECOND; });
  while (rig.time() < 500 * GST_MSECOND) rig.crank();
  const double before = rig.poses().back().pan;
  fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PAUSED), GST_STATE_CHANGE_SUCCESS);
  // Published to the end: at 40 degrees a second for the latency of 60 ms, then braking at 600.
  const auto poses = rig.poses();
  fail_unless(poses.front().moving && !poses.back().moving);
  fail_unless_equals_uint64(poses.back().valid_until, GST_CLOCK_TIME_NONE);
  const double way = 40 * 0.06 + 40 * 40 / 1200.0;
  fail_unless(std::fabs(poses.back().pan - before - way) < 1e-6, "%g", poses.back().pan - before);
  const auto messages = rig.messages();
  fail_unless_equals_string(messages.back().reason.c_str(), "paused");
  // What the application wants meanwhile is done afterwards.
  fail_unless(rig.call("move-to", -30, 0));
  fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PLAYING), GST_STATE_CHANGE_SUCCESS);
  while (rig.time() < 4 * GST_SECOND) rig.crank();
  fail_unless(std::fabs(rig.poses().back().pan + 30) < 1e-9);
}
GST_END_TEST

GST_START_TEST(an_order_that_goes_on_says_so) {
  for (const Answers answers : {Answers::at_once, Answers::on_a_thread})
    assert_said("manual stopped, manual (manual command: move), stopped manual", answers, [answers] {
      Rig rig(answers == Answers::on_a_thread ? scripted("") : "", Source::live);
      fail_unless(rig.call("move-to", 90, 0));
      gst_element_set_state(rig.element, GST_STATE_PAUSED);
      std::string said = rig.states() + ",";
      gst_element_set_state(rig.element, GST_STATE_PLAYING);
      for (const Message& message : rig.messages()) said += " " + message.state + " (" + message.reason + ")";
      fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_start()));
      fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_stop(TRUE)));
      return said + ", " + rig.states();
    });
}
GST_END_TEST

GST_START_TEST(after_a_fault_the_state_is_that_of_the_order_before_it) {
  Pipe gate;
  Rig rig("driver=scripted script=\"state wait " + gate.reader() + "\"", Source::live);
  fail_unless(rig.call("move-to", 90, 0));
  std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "manual");
  while ((states = rig.states()).empty()) rig.crank();  // it is silent
  fail_unless_equals_string(states.c_str(), "fault");
  gate.close_writer();
  while ((states = rig.states()).empty()) rig.crank();
  fail_unless_equals_string(states.c_str(), "manual");
}
GST_END_TEST

// The driver would take the order as soon as it returns from the call in which it hangs.
GST_START_TEST(an_order_to_a_head_that_does_not_answer_moves_nothing_later) {
  Pipe gate, record;
  Rig rig("driver=scripted script=\"record " + record.writer() + "; state wait " + gate.reader() + "\"",
          Source::live);
  std::string states;
  while ((states = rig.states()).empty()) rig.crank();
  fail_unless_equals_string(states.c_str(), "fault");
  fail_unless(rig.call("move-to", 90, 0));
  rig.crank();
  gate.close_writer();
  while ((states = rig.states()).find("manual") == std::string::npos) rig.crank();
  for (int k = 0; k < 10; ++k) rig.crank();
  rig.call("stop");
  std::string line;
  do fail_if((line = record.line()).find("position") != std::string::npos, "%s", line.c_str());
  while (!line.starts_with("command"));
}
GST_END_TEST

GST_START_TEST(an_order_does_not_survive_the_end_of_the_stream) {
  Rig rig("max-speed=20", Source::live);
  rig.push(frame_with(CERBERUS_FUSION_HOLD, 0));
  fail_unless(rig.call("move-to", 90, 0));
  while (rig.time() < 300 * GST_MSECOND) rig.crank();
  fail_unless(gst_harness_push_event(rig.harness, gst_event_new_eos()));
  while (rig.time() < GST_SECOND) rig.crank();
  const CerberusPose end = rig.poses().back();
  fail_unless(!end.moving && end.pan > 0 && end.pan < 20, "%g", end.pan);
  gst_element_set_state(rig.element, GST_STATE_PAUSED);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  fail_if(rig.call("move-to", -60, 0));
  while (rig.time() < 3 * GST_SECOND) rig.crank();
  for (const CerberusPose& pose : rig.poses()) fail_unless(pose.pan == end.pan && !pose.moving);
  const auto messages = rig.messages();
  fail_unless_equals_string(messages.back().reason.c_str(), "end of the stream");
}
GST_END_TEST

GST_START_TEST(a_driver_that_fails_warns_once_and_the_video_goes_on) {
  for (const Source source : {Source::stored, Source::live}) {
    Pipe record;
    const std::string head = new_head();
    Rig rig(scripted("record " + record.writer() + "; command 2 fail no power", head), source);
    for (int k = 0; k < 10; ++k) {
      rig.push(frame_with(k % 2 ? CERBERUS_FUSION_TURN_LEFT : CERBERUS_FUSION_TURN_RIGHT, k * kFrame));
      while (!record.line().starts_with("command")) {
      }
      if (k > 0) fail_unless(record.line().starts_with("stop"));
    }
    GstMessage* warning = gst_bus_timed_pop_filtered(rig.bus, 60 * GST_SECOND, GST_MESSAGE_WARNING);
    fail_unless(warning != nullptr);
    GError* error = nullptr;
    gst_message_parse_warning(warning, &error, nullptr);
    const std::string name = "\"" + head + "\"";
    fail_unless(strstr(error->message, name.c_str()) && strstr(error->message, "no power"), "%s",
                error->message);
    g_error_free(error);
    gst_message_unref(warning);
    fail_unless(gst_bus_pop_filtered(rig.bus, static_cast<GstMessageType>(GST_MESSAGE_WARNING |
                                                                          GST_MESSAGE_ERROR)) == nullptr);
  }
}
GST_END_TEST

// The error text when the element does not start, posted once. A driver on a thread of its own may fail a moment
// later.
std::string refusal(const std::string& properties, const char* script = nullptr, const char* head = nullptr) {
  GstElement* element = gst_parse_launch(("pantiltsink " + properties).c_str(), nullptr);
  gst_object_ref_sink(element);
  if (script) g_object_set(element, "script", script, nullptr);
  if (head) g_object_set(element, "head", head, nullptr);
  GstBus* bus = gst_bus_new();
  gst_element_set_bus(element, bus);
  const bool late = gst_element_set_state(element, GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE;
  fail_if(late && properties.find("driver=scripted") == std::string::npos, "%s: started", properties.c_str());
  std::string text;
  while (GstMessage* message =
             gst_bus_timed_pop_filtered(bus, late && text.empty() ? 60 * GST_SECOND : 0, GST_MESSAGE_ERROR)) {
    GError* error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    fail_unless(text.empty(), "and also: %s", error->message);
    text = error->message;
    g_error_free(error);
    gst_message_unref(message);
  }
  gst_element_set_state(element, GST_STATE_NULL);
  gst_element_set_bus(element, nullptr);
  gst_object_unref(bus);
  gst_object_unref(element);
  return text;
}

GST_START_TEST(what_cannot_be_is_refused_with_its_name) {
  const std::pair<const char*, const char*> cases[] = {
      {"driver=nonsense", "no head driver \"nonsense\": take one of simulated, scripted"},
      {"pan-min=10", "pan-min 10 and pan-max 170 exclude 0"},
      {"tilt-max=-1", "tilt-min -45 and tilt-max -1 exclude 0"},
      {"latency=6000000000", ": latency must be 0 to 5 s, and is 6 s."},
      {"start-pan=-170.5", ": start-pan -170.5 is not between pan-min -170 and pan-max 170."},
      {"driver=scripted head=attic start-tilt=50",
       ": start-tilt 50 is not between tilt-min -45 and tilt-max 45."},
      {"pan-max=0 start-pan=0.5", ": start-pan 0.5 is not between pan-min -170 and pan-max 0."},
      {"driver=scripted head=cellar script=\"open fail no such device\"",
       "head \"cellar\" cannot be opened: no such device"},
      {"driver=scripted script=nonsense", "script: 'nonsense'"},
  };
  for (const auto& [properties, expected] : cases) {
    const std::string text = refusal(properties);
    fail_unless(text.find(expected) != std::string::npos, "%s: '%s'", properties, text.c_str());
  }
}
GST_END_TEST

// GStreamer drops a message with a field that is not UTF-8 and logs a warning of its own.
GST_START_TEST(whatever_a_driver_says_arrives) {
  fail_unless(says(refusal(scripted("", "attic"), "open fail T\xfcr zu"), "cannot be opened: T\\xfcr zu."));
  fail_unless(says(refusal(scripted("", "attic"), "\xff"), "script: '\\xff'"));
  fail_unless(says(refusal("", nullptr, "T\xfcr"), "name \"T\\xfcr\" is no UTF-8"));
  Rig rig(scripted(""), Source::live, false);
  gst_element_set_state(rig.element, GST_STATE_READY);
  g_object_set(rig.element, "script", "command 2 fail T\xfcr zu", nullptr);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  rig.begin();
  bool warned = false, reported = false;
  for (int frames = 0; !warned || !reported;) {
    const auto kinds = static_cast<GstMessageType>(GST_MESSAGE_WARNING | GST_MESSAGE_ELEMENT);
    g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(rig.bus, 50 * GST_MSECOND, kinds);
    if (!message) {  // a driver that is still at the command before gets the newest one only
      fail_unless(frames < 1000);
      rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, frames++ * kFrame));
      continue;
    }
    const HeadState state(message);
    if (!state.state.empty()) {
      if (state.state == "fault") reported = says(state.reason.c_str(), "T\\xfcr zu");
      continue;
    }
    fail_unless(GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING);
    g_autoptr(GError) error = nullptr;
    gst_message_parse_warning(message, &error, nullptr);
    warned = says(error->message, "fails: T\\xfcr zu");
  }
}
GST_END_TEST

// Later than a change of state may wait for it.
GST_START_TEST(a_head_that_cannot_be_opened_is_an_error_however_late) {
  Pipe gate;
  Rig rig("driver=scripted script=\"open wait " + gate.reader() + "; open fail no such serial port\"",
          Source::live);
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, 0));
  gate.close_writer();
  GstMessage* message = nullptr;
  while (!(message = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ERROR))) rig.crank();
  GError* error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  fail_unless_equals_string(error->message, "The head \"head\" cannot be opened: no such serial port.");
  fail_unless(g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_OPEN_READ_WRITE));
  g_error_free(error);
  gst_message_unref(message);
  // Once.
  rig.push(frame_with(CERBERUS_FUSION_TURN_RIGHT, GST_SECOND));
  for (int k = 0; k < 20; ++k) rig.crank();
  fail_unless(gst_bus_pop_filtered(
                  rig.bus, static_cast<GstMessageType>(GST_MESSAGE_WARNING | GST_MESSAGE_ERROR)) == nullptr);
}
GST_END_TEST

// Nothing else happens in PAUSED that could trigger the report.
GST_START_TEST(a_head_that_cannot_be_opened_says_so_in_paused_too) {
  Pipe gate;
  const std::string line =
      "pantiltsink driver=scripted script=\"open wait " + gate.reader() + "; open fail no such serial port\"";
  g_autoptr(GstElement) element = gst_parse_launch(line.c_str(), nullptr);
  gst_object_ref_sink(element);
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(element, bus);
  fail_if(gst_element_set_state(element, GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
  gate.close_writer();
  g_autoptr(GstMessage) message = gst_bus_timed_pop_filtered(bus, 60 * GST_SECOND, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  fail_unless_equals_string(error->message, "The head \"head\" cannot be opened: no such serial port.");
  for (const GstState state : {GST_STATE_PLAYING, GST_STATE_NULL}) gst_element_set_state(element, state);
  fail_unless(gst_bus_pop_filtered(
                  bus, static_cast<GstMessageType>(GST_MESSAGE_WARNING | GST_MESSAGE_ERROR)) == nullptr);
  gst_element_set_bus(element, nullptr);
}
GST_END_TEST

GST_START_TEST(one_head_has_one_sink) {
  {
    Rig first("head=door");
    fail_unless(refusal("head=door").find("Another pantiltsink drives the head \"door\"") !=
                std::string::npos);
    Rig other("head=gate");
  }
  Rig again("head=door");
}
GST_END_TEST

GST_START_TEST(a_pose_event_of_another_head_passes_and_changes_nothing) {
  Rig rig;
  rig.poses();
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.pan = 77;
  fail_unless(gst_element_send_event(rig.element, cerberus_event_new_pose(&pose)));
  fail_unless(rig.next_pose().pan == 77);
  rig.push(frame_with(CERBERUS_FUSION_HOLD, 0));
  fail_unless(rig.poses().back().pan == 0);
}
GST_END_TEST

GST_START_TEST(caps_without_a_size_are_refused) {
  GstHarness* harness = gst_harness_new("pantiltsink");
  GstBus* bus = gst_bus_new();
  gst_element_set_bus(harness->element, bus);
  gst_harness_set_src_caps_str(harness, "video/x-raw,format=GRAY8");
  gst_harness_push(harness, frame_at(0));
  GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
  gst_message_unref(message);
  gst_element_set_bus(harness->element, nullptr);
  gst_object_unref(bus);
  gst_harness_teardown(harness);
}
GST_END_TEST

int threads() {
  return entries("/proc/self/task");
}

GST_START_TEST(many_starts_and_stops_leave_no_thread) {
  const int before = threads();
  GstElement* element = gst_element_factory_make("pantiltsink", nullptr);
  for (int k = 0; k < 1000; ++k) {
    fail_if(gst_element_set_state(element, GST_STATE_PLAYING) == GST_STATE_CHANGE_FAILURE);
    fail_if(gst_element_set_state(element, GST_STATE_NULL) == GST_STATE_CHANGE_FAILURE);
  }
  gst_object_unref(element);
  // A thread that was joined may be listed for a moment longer.
  for (int k = 0; k < 6000 && threads() > before; ++k) g_usleep(10000);
  fail_unless_equals_int(threads(), before);
}
GST_END_TEST

Suite* pantiltsink_live_suite() {
  Suite* suite = suite_create("pantiltsink with a clock");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, at_rest_poses_come_five_times_a_second);
  tcase_add_test(tests, a_moving_head_tells_where_it_is_fifty_times_a_second);
  tcase_add_test(tests, a_piece_that_ends_is_followed_by_the_next_at_that_time);
  tcase_add_test(tests, when_frames_stay_away_the_head_stops);
  tcase_add_test(tests, a_single_time_stamp_that_is_far_off_blinds_no_live_head_and_old_frames_move_none);
  tcase_add_test(tests, when_frames_stay_away_an_order_is_over);
  tcase_add_test(tests, in_pause_a_head_with_a_clock_stands_still);
  tcase_add_test(tests, an_order_that_goes_on_says_so);
  tcase_add_test(tests, after_a_fault_the_state_is_that_of_the_order_before_it);
  tcase_add_test(tests, an_order_to_a_head_that_does_not_answer_moves_nothing_later);
  tcase_add_test(tests, an_order_does_not_survive_the_end_of_the_stream);
  tcase_add_test(tests, a_driver_that_fails_warns_once_and_the_video_goes_on);
  tcase_add_test(tests, what_cannot_be_is_refused_with_its_name);
  tcase_add_test(tests, whatever_a_driver_says_arrives);
  tcase_add_test(tests, a_head_that_cannot_be_opened_is_an_error_however_late);
  tcase_add_test(tests, a_head_that_cannot_be_opened_says_so_in_paused_too);
  tcase_add_test(tests, one_head_has_one_sink);
  tcase_add_test(tests, a_pose_event_of_another_head_passes_and_changes_nothing);
  tcase_add_test(tests, caps_without_a_size_are_refused);
  tcase_add_test(tests, many_starts_and_stops_leave_no_thread);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(pantiltsink_live);
