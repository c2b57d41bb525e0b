// SPDX-License-Identifier: LGPL-2.1-or-later
// pirfusion's decisions: its inputs from frames and events, and its outputs. (The rules are tested in
// pirfusion_rules.cpp, the pads' input in pirfusion_pads.cpp, waiting in pirfusion_waiting.cpp.)
#include <cmath>

#include "cerberus/private/follow_query.hpp"
#include "fusion_rig.h"

namespace {

using namespace rig;

// The upstream events that reached this harness' source.
std::vector<std::string> events_up(GstHarness* h) {
  std::vector<std::string> names;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(h)) {
    const GstStructure* s = gst_event_get_structure(event);
    if (GST_EVENT_TYPE(event) != GST_EVENT_RECONFIGURE && GST_EVENT_TYPE(event) != GST_EVENT_LATENCY)
      names.push_back(GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_UPSTREAM ? gst_structure_get_name(s)
                                                                         : GST_EVENT_TYPE_NAME(event));
    gst_event_unref(event);
  }
  return names;
}

// A frame with the tracks 5 and 6, which is larger and newer.
GstBuffer* two(GstClockTime time) {
  GstBuffer* buffer = frame_with(time, 5, 1);
  CerberusRegion large;
  cerberus_region_init(&large);
  large.id = 6;
  large.tracked = TRUE;
  large.width = large.height = 8;
  large.age = GST_SECOND;
  cerberus_buffer_add_region(buffer, &large);
  return buffer;
}

}  // namespace

GST_START_TEST(every_frame_carries_a_decision_and_only_changes_are_posted) {
  Rig rig(true, "return-delay=0");
  for (int k = 0; k < 5; ++k) {
    const CerberusFusion fusion = rig.at(k * 40 * kMs);
    fail_unless_equals_int(fusion.action, CERBERUS_FUSION_ZERO);
    fail_unless_equals_int(fusion.rule, 7);
    fail_unless_equals_string(fusion.rule_name, "zero");
    fail_unless_equals_int(fusion.n_sensors, 0);
    fail_if(fusion.camera_found || fusion.limited || fusion.target);
    fail_unless(std::isnan(fusion.pan) && std::isnan(fusion.sector_from));
  }
  for (int k = 5; k < 8; ++k) {
    const CerberusFusion fusion = rig.show(frame_with(k * 40 * kMs, 9));
    fail_unless(fusion.camera_found);
    fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TRACK);
    fail_unless_equals_int(fusion.target, 9);
  }
  const auto posted = rig.posted();
  fail_unless_equals_int(posted.size(), 2);
  assert_says(posted[0], "0:7:zero");
  assert_says(posted[1], "200:1:track");
}
GST_END_TEST

GST_START_TEST(only_confirmed_tracks_make_the_camera_found) {
  Rig rig;
  const CerberusFusion fusion = rig.show(frame_with(0, 0));  // a region without an identity
  fail_if(fusion.camera_found || fusion.target);
  fail_unless(rig.show(frame_with(40 * kMs, 8)).camera_found);
  // Kept for camera-hold: held, not tracked.
  const CerberusFusion gone = rig.at(500 * kMs);
  fail_unless(gone.camera_found && gone.target == 0);
  fail_unless_equals_int(gone.action, CERBERUS_FUSION_HOLD);
  fail_if(rig.at(600 * kMs).camera_found);
}
GST_END_TEST

GST_START_TEST(a_verified_person_is_the_target_in_place_of_what_only_moves) {
  Rig rig(true, "target=largest");
  fail_unless_equals_int(rig.show(two(0)).target, 6);
  CerberusRegion person;
  cerberus_region_init(&person);
  person.id = 7;
  person.tracked = person.person = TRUE;
  person.width = person.height = 2;
  guint32 target = 0;
  for (int k = 1; k <= 15; ++k) {
    GstBuffer* buffer = two(k * 40 * kMs);
    fail_unless(cerberus_buffer_add_region(buffer, &person));
    target = rig.show(buffer).target;
    if (k == 1) fail_unless_equals_int(target, 6);  // it may be for a moment only
  }
  fail_unless_equals_int(target, 7);
  fail_unless_equals_int(rig.show(two(640 * kMs)).target, 6);
}
GST_END_TEST

GST_START_TEST(properties_count_while_playing) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {0, 1, 0});
  CerberusFusion fusion = rig.show(frame_at(0, -90));
  fail_unless_equals_string(fusion.rule_name, "sector");
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_SEARCH);
  // -180 .. -60 less half a lens at the right, the stop at the left.
  fail_unless(std::abs(fusion.sector_from + 150) < 1e-9 && std::abs(fusion.sector_to + 90) < 1e-9, "%g %g",
              fusion.sector_from, fusion.sector_to);
  g_object_set(rig.element, "horizontal-fov", 0.0, "pan-min", -100.0, nullptr);
  fusion = rig.show(frame_at(40 * kMs, -90));
  fail_unless(std::abs(fusion.sector_from + 100) < 1e-9 && std::abs(fusion.sector_to + 60) < 1e-9, "%g %g",
              fusion.sector_from, fusion.sector_to);
  fail_unless(fusion.limited);
  g_object_set(rig.element, "rules", 1, nullptr);
  fail_unless_equals_int(rig.show(frame_at(80 * kMs, -90)).rule, 3);
  g_object_set(rig.element, "rules", 0, "return-delay", guint64{200 * kMs}, nullptr);
  rig.read(120 * kMs, {0, 0, 0});
  fail_unless_equals_int(rig.show(frame_at(120 * kMs, -90)).rule, 0);
  fail_unless_equals_int(rig.show(frame_at(400 * kMs, -90)).action, CERBERUS_FUSION_ZERO);
  // The choice of target: the larger, the newer; a followed track is kept.
  g_object_set(rig.element, "target", 1, "camera-hold", guint64{0}, nullptr);
  fail_unless_equals_int(rig.show(two(440 * kMs)).target, 6);
  g_object_set(rig.element, "target", 2, nullptr);
  fail_unless_equals_int(rig.show(two(480 * kMs)).target, 6);
  rig.show(frame_with(520 * kMs, 7));
  fail_unless_equals_int(rig.show(two(560 * kMs)).target, 5);
  // Limits in the wrong order: a warning, and the old ones stay in force.
  g_object_set(rig.element, "pan-min", 200.0, nullptr);
  rig.at(600 * kMs);
  const std::string warning = rig.warning();
  fail_unless(warning.find("pan-min 200 and pan-max 170") != std::string::npos, "%s", warning.c_str());
  double pan_min = 0;
  g_object_get(rig.element, "pan-min", &pan_min, nullptr);
  fail_unless(pan_min < 0, "%g", pan_min);  // as in force
}
GST_END_TEST

GST_START_TEST(the_choice_of_its_head_downstream_is_the_decision_until_that_ends_it) {
  Rig rig(true, "head=gate target=largest");
  const auto follow = [&](const char* head, guint track) {
    return cerberus::ask_to_follow(rig.video->sinkpad, head, track);
  };
  fail_unless_equals_int(rig.show(two(0)).target, 6);
  fail_if(follow("door", 5));
  fail_unless_equals_int(rig.show(two(40 * kMs)).target, 6);
  fail_unless(follow("gate", 5));
  CerberusFusion fusion = rig.show(two(80 * kMs));
  fail_unless_equals_int(fusion.target, 5);
  fail_unless_equals_string(fusion.rule_name, "chosen");
  fail_unless_equals_int(fusion.rule, 0);
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TRACK);
  assert_says(rig.posted().back(), "80:0:track");
  fail_unless(follow("gate", 0));
  fusion = rig.show(two(120 * kMs));
  fail_unless_equals_string(fusion.rule_name, "camera");
}
GST_END_TEST

GST_START_TEST(hysteresis_and_hold_stopped_are_the_users) {
  for (const double hysteresis : {0.0, 5.0}) {
    Rig rig(true, "hysteresis=" + std::to_string(hysteresis));
    rig.add_pir();
    rig.read(0, {1, 0, 0});
    fail_unless_equals_int(rig.show(frame_at(0, 59)).action, CERBERUS_FUSION_SEARCH);
    fail_unless_equals_int(rig.show(frame_at(40 * kMs, 64)).action,
                           hysteresis > 4 ? CERBERUS_FUSION_SEARCH : CERBERUS_FUSION_TURN_LEFT);
  }
  Rig rig(true, "camera-hold=0 return-delay=0 hold-stopped=" + std::to_string(GST_SECOND));
  rig.show(frame_with(0, 3, 4, CERBERUS_REGION_STOPPED));
  fail_unless_equals_string(rig.at(900 * kMs).rule_name, "stopped");
  fail_unless_equals_int(rig.at(1100 * kMs).action, CERBERUS_FUSION_ZERO);
}
GST_END_TEST

GST_START_TEST(two_of_them_know_nothing_of_each_other) {
  Rig one(true, "rules=paper"), two(true, "head=other");
  one.add_pir();
  two.add_pir(with_sensors(1, 0, 0).c_str());
  one.read(0, {0, 1, 0});
  two.read(0, {0});
  say(one, pose(20));
  say(two, pose(-20, 0, 0, "other"));
  const CerberusFusion a = one.at(0), b = two.show(frame_with(0, 4));
  fail_unless(a.pan == 20 && b.pan == -20);
  fail_unless(a.rule == 3 && b.rule == 1);
  fail_unless(text(sensors(a)) == "010" && text(sensors(b)) == "0");
}
GST_END_TEST

GST_START_TEST(it_begins_anew_after_it_was_stopped) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {1, 0, 0});
  say(rig, pose(33));
  fail_unless(rig.show(frame_with(0, 5)).pan == 33);
  gst_element_set_state(rig.element, GST_STATE_READY);
  gst_element_set_state(rig.element, GST_STATE_PLAYING);
  gst_harness_set_src_caps_str(rig.video, kVideo);
  gst_harness_push_event(rig.video, gst_event_new_stream_start("again"));
  push_segment(rig.video);
  const CerberusFusion fusion = rig.at(40 * kMs);
  fail_unless(std::isnan(fusion.pan) && !fusion.camera_found);
  assert_says(text(sensors(fusion)), "2");  // of the pad, whose caps are cleared, too
}
GST_END_TEST

GST_START_TEST(pan_comes_from_the_frame_else_from_the_events_that_passed) {
  Rig rig;
  fail_unless(std::isnan(rig.at(0).pan));
  say(rig, pose(10, 100 * kMs, 50));  // 10 degrees at 0.1 s, 50 degrees a second
  say(rig, pose(60, 900 * kMs));
  fail_unless(rig.at(40 * kMs).pan == 10);  // before the first one: where it begins
  fail_unless(std::abs(rig.at(100 * kMs).pan - 10) < 1e-9);
  fail_unless(std::abs(rig.at(300 * kMs).pan - 20) < 1e-9);
  fail_unless(rig.show(frame_at(500 * kMs, -77)).pan == -77);
  fail_unless(std::abs(rig.at(700 * kMs).pan - 40) < 1e-9);
  fail_unless(rig.at(900 * kMs).pan == 60);
  fail_unless(rig.at(5 * GST_SECOND).pan == 60);
}
GST_END_TEST

// The head turns by 20 degrees a second. A repeated picture was taken when the last new one came.
GST_START_TEST(a_repeated_frame_is_decided_with_the_pose_of_its_picture_and_the_newest_readings) {
  Rig rig;
  rig.add_pir();
  rig.read(0, {0, 0, 0});
  say(rig, pose(10, 0, 20));
  CerberusFusion fusion = rig.show(frame_with(0, 9));
  fail_unless(std::abs(fusion.pan - 10) < 1e-9, "%g", fusion.pan);
  rig.read(50 * kMs, {0, 1, 0});
  GstBuffer* again = frame_with(100 * kMs, 9);
  GST_BUFFER_FLAG_SET(again, GST_BUFFER_FLAG_GAP);
  fusion = rig.show(again);
  fail_unless(std::abs(fusion.pan - 10) < 1e-9, "%g", fusion.pan);
  assert_says(text(sensors(fusion)), "010");
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TRACK);
  fail_unless_equals_int(fusion.target, 9);
  fusion = rig.show(frame_with(200 * kMs, 9));
  fail_unless(std::abs(fusion.pan - 14) < 1e-9, "%g", fusion.pan);
}
GST_END_TEST

GST_START_TEST(a_pose_of_another_head_is_forwarded_and_not_used) {
  Rig rig;
  GstHarness* pir = rig.add_pir();
  events_up(rig.video);
  events_up(pir);
  say(rig, pose(30));
  say(rig, pose(90, 0, 0, "another"));
  say(rig, gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty(CERBERUS_EVENT_POSE)));
  say(rig, gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty("something")));
  CerberusPose absurd = pose(80);
  GstEvent* event = cerberus_event_new_pose(&absurd);
  gst_structure_set(gst_event_writable_structure(event), "pan", G_TYPE_DOUBLE, HUGE_VAL, nullptr);
  say(rig, event);
  fail_unless(rig.at(0).pan == 30);
  const std::vector<std::string> expected = {CERBERUS_EVENT_POSE, CERBERUS_EVENT_POSE, CERBERUS_EVENT_POSE,
                                             "something", CERBERUS_EVENT_POSE};
  fail_unless(events_up(rig.video) == expected);
  fail_unless(events_up(pir) == expected);  // a PIR source receives it as well
  // The pose on the frame may be another head's.
  GstBuffer* buffer = frame(40 * kMs);
  const CerberusPose strange = pose(-50, 40 * kMs, 0, "another");
  cerberus_buffer_set_pose(buffer, &strange);
  fail_unless(rig.show(buffer).pan == 30);
  // The other head is selected: the first one's poses are ignored from now on.
  g_object_set(rig.element, "head", "another", nullptr);
  fail_unless(std::isnan(rig.at(80 * kMs).pan));
  say(rig, pose(91, 0, 0, "another"));
  fail_unless(rig.at(120 * kMs).pan == 91);
  g_object_set(rig.element, "head", "", nullptr);
  say(rig, pose(92, 0, 0, "another"));
  fail_unless(rig.at(160 * kMs).pan == 92);
}
GST_END_TEST

namespace {

// The onsets that have gone upstream since the last call.
int onsets(Rig& rig) {
  int count = 0;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(rig.video)) {
    count += gst_event_has_name(event, "cerberus-onset");
    gst_event_unref(event);
  }
  return count;
}

}  // namespace

// The lens sees 30 degrees to either side, the sensors (ahead, left, right) 60; live and not.
GST_START_TEST(a_sensor_that_begins_to_detect_in_the_picture_is_told_upstream_once) {
  for (const bool live : {true, false}) {
    Rig rig(live);
    rig.add_pir(kPaper, "pir_%u", live);
    const auto after = [&](int k, const Bytes& values, double pan) {
      const GstClockTime time = static_cast<GstClockTime>(k) * 40 * kMs;
      rig.read(time, values);
      if (!live) rig.read(time + 20 * kMs, values);
      rig.show(frame_at(time, pan));
      return onsets(rig);
    };
    fail_unless_equals_int(after(0, {0, 0, 0}, 0), 0);
    fail_unless_equals_int(after(1, {1, 0, 0}, 0), 1);
    fail_unless_equals_int(after(2, {1, 0, 0}, 0), 0);   // it goes on
    fail_unless_equals_int(after(3, {1, 1, 0}, 0), 0);   // elsewhere
    fail_unless_equals_int(after(4, {1, 1, 1}, 60), 1);  // from the middle of the picture on
    fail_unless_equals_int(after(5, {2, 0, 0}, 0), 0);   // invalid
  }
}
GST_END_TEST

GST_START_TEST(readings_while_the_robot_turns_are_doubtful) {
  Rig rig(true, "lost-after=0");
  rig.add_pir();
  rig.read(0, {0, 0, 0});
  say(rig, base_event(-5.1, 100 * kMs));
  say(rig, base_event(4.9, 10 * GST_SECOND));
  rig.show(frame_at(0, 0));
  rig.read(200 * kMs, {0, 0, 1});
  CerberusFusion fusion = rig.show(frame_at(240 * kMs, 0));
  fail_unless_equals_int(fusion.doubtful, 0b100);
  assert_says(text(sensors(fusion)), "001");  // reported as it was read
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_HOLD);
  fail_unless_equals_int(rig.show(frame_at(10 * GST_SECOND, 0)).doubtful, 0b100);  // just after
  fusion = rig.show(frame_at(14 * GST_SECOND, 0));                                 // calm for long
  fail_unless_equals_int(fusion.doubtful, 0);
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_TURN_RIGHT);
}
GST_END_TEST

// Without an event, cameramotion's yaw rate is used and sent to the sensors' sources, which see no frames.
GST_START_TEST(a_turning_that_the_camera_saw_makes_readings_doubtful) {
  const auto turning = [](GstClockTime time, double rate) {
    GstBuffer* buffer = frame_at(time, 0);
    CerberusBase base;
    cerberus_base_init(&base);
    base.yaw_rate = rate;
    cerberus_buffer_set_base(buffer, &base);
    return buffer;
  };
  Rig rig;
  GstHarness* pir = rig.add_pir();
  rig.read(0, {1, 0, 0});
  fail_unless_equals_int(rig.show(turning(0, 4.9)).doubtful, 0);
  rig.read(40 * kMs, {1, 1, 0});
  fail_unless_equals_int(rig.show(turning(40 * kMs, 5.1)).doubtful, 0b010);
  fail_unless_equals_int(rig.show(turning(80 * kMs, -20)).doubtful, 0b010);
  fail_unless_equals_int(rig.show(turning(120 * kMs, -20.5)).doubtful, 0b010);
  fail_unless_equals_int(rig.show(frame_at(160 * kMs, 0)).doubtful, 0b010);  // just after
  std::vector<double> received;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(pir)) {
    double rate = 0;
    if (parse_base(event, &rate, nullptr)) received.push_back(rate);
    gst_event_unref(event);
  }
  // Not each small change, but always what makes a doubt or ends it.
  fail_unless(received == std::vector<double>({4.9, 5.1, -20, 0}));
  // The application's value takes precedence until it stops sending.
  say(rig, base_event(0, 200 * kMs));
  rig.read(1000 * kMs, {1, 0, 0});
  fail_unless_equals_int(rig.show(turning(1199 * kMs, 40)).doubtful, 0);
  rig.read(1200 * kMs, {1, 0, 1});
  fail_unless_equals_int(rig.show(turning(1200 * kMs, 40)).doubtful, 0b100);
}
GST_END_TEST

// The paper's sensors all see to the side. What a straight way does to them is independent of the turn, which the camera
// sees.
GST_START_TEST(a_robot_that_drives_makes_readings_doubtful) {
  Rig rig(true, "lost-after=0");
  GstHarness* pir = rig.add_pir();
  rig.read(0, {0, 0, 0});
  say(rig, drive_event(.1, 0));
  rig.show(frame_at(0, 0));
  rig.read(100 * kMs, {1, 0, 0});
  fail_unless_equals_int(rig.show(frame_at(100 * kMs, 0)).doubtful, 0);
  say(rig, drive_event(-.5, 200 * kMs));
  rig.read(300 * kMs, {1, 0, 1});
  fail_unless_equals_int(rig.show(frame_at(300 * kMs, 0)).doubtful, 0b100);
  fail_unless_equals_int(rig.show(frame_at(1300 * kMs, 0)).doubtful, 0b100);  // the event has expired
  GstBuffer* turning = frame_at(1400 * kMs, 0);
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = 20;
  cerberus_buffer_set_base(turning, &base);
  say(rig, drive_event(0, 1400 * kMs));
  rig.read(1400 * kMs, {1, 1, 1});
  fail_unless_equals_int(rig.show(turning).doubtful, 0b110);
  std::vector<double> speeds, rates;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(pir)) {
    g_autoptr(CerberusBase) sent = cerberus_event_parse_base(event);
    if (sent && std::isfinite(sent->speed)) speeds.push_back(sent->speed);
    if (sent && std::isfinite(sent->yaw_rate)) rates.push_back(sent->yaw_rate);
    gst_event_unref(event);
  }
  fail_unless(speeds == std::vector<double>({.1, -.5, 0}));
  fail_unless(rates == std::vector<double>({20}));
}
GST_END_TEST

// They would forget it within a second; that it stands they take silence for.
GST_START_TEST(the_sensors_sources_receive_the_rate_again_while_the_robot_turns) {
  Rig rig;
  GstHarness* pir = rig.add_pir();
  std::vector<GstClockTime> sent;
  for (GstClockTime time = 0; time < 5 * GST_SECOND; time += 40 * kMs) {
    GstBuffer* buffer = frame_at(time, 0);
    CerberusBase base;
    cerberus_base_init(&base);
    base.yaw_rate = time < 3 * GST_SECOND ? 20 : 0;
    cerberus_buffer_set_base(buffer, &base);
    rig.show(buffer);
    while (GstEvent* event = gst_harness_try_pull_upstream_event(pir)) {
      double rate = 0;
      if (parse_base(event, &rate, nullptr)) {
        fail_unless_equals_float(rate, base.yaw_rate);
        sent.push_back(time);
      }
      gst_event_unref(event);
    }
  }
  fail_unless(sent == std::vector<GstClockTime>(
                          {0, 520 * kMs, 1040 * kMs, 1560 * kMs, 2080 * kMs, 2600 * kMs, 3 * GST_SECOND}));
}
GST_END_TEST

GST_START_TEST(a_seek_reaches_the_pir_sources_and_the_video_source) {
  Rig rig;
  GstHarness* pir = rig.add_pir();
  events_up(rig.video);
  events_up(pir);
  say(rig, gst_event_new_seek(1, GST_FORMAT_TIME, GST_SEEK_FLAG_NONE, GST_SEEK_TYPE_SET, 0,
                              GST_SEEK_TYPE_NONE, 0));
  say(rig, gst_event_new_qos(GST_QOS_TYPE_UNDERFLOW, 1, 0, 0));
  const std::vector<std::string> video = {"seek", "qos"}, readings = {"seek"};
  fail_unless(events_up(rig.video) == video);
  fail_unless(events_up(pir) == readings);
}
GST_END_TEST

static Suite* pirfusion_suite() {
  watch_library_log();
  Suite* s = suite_create("pirfusion");
  TCase* tc = tcase_create("decisions");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, every_frame_carries_a_decision_and_only_changes_are_posted);
  tcase_add_test(tc, only_confirmed_tracks_make_the_camera_found);
  tcase_add_test(tc, a_verified_person_is_the_target_in_place_of_what_only_moves);
  tcase_add_test(tc, properties_count_while_playing);
  tcase_add_test(tc, the_choice_of_its_head_downstream_is_the_decision_until_that_ends_it);
  tcase_add_test(tc, hysteresis_and_hold_stopped_are_the_users);
  tcase_add_test(tc, two_of_them_know_nothing_of_each_other);
  tcase_add_test(tc, it_begins_anew_after_it_was_stopped);
  tc = tcase_create("head");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, pan_comes_from_the_frame_else_from_the_events_that_passed);
  tcase_add_test(tc, a_repeated_frame_is_decided_with_the_pose_of_its_picture_and_the_newest_readings);
  tcase_add_test(tc, a_pose_of_another_head_is_forwarded_and_not_used);
  tcase_add_test(tc, a_sensor_that_begins_to_detect_in_the_picture_is_told_upstream_once);
  tcase_add_test(tc, readings_while_the_robot_turns_are_doubtful);
  tcase_add_test(tc, a_turning_that_the_camera_saw_makes_readings_doubtful);
  tcase_add_test(tc, a_robot_that_drives_makes_readings_doubtful);
  tcase_add_test(tc, the_sensors_sources_receive_the_rate_again_while_the_robot_turns);
  tcase_add_test(tc, a_seek_reaches_the_pir_sources_and_the_video_source);
  return s;
}

GST_CHECK_MAIN(pirfusion)
