// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink in a pipeline that is not live: time is that of the frames, so every pose is known beforehand.
#include <chrono>  // before gst-check, whose macros break standard headers

#include "head_rig.h"
#include "promises.h"

namespace {

using namespace head_rig;

// The head's pan at `time`, degrees, from the published poses.
double pan_at(const std::vector<CerberusPose>& poses, GstClockTime time) {
  double pan = NAN;
  for (const CerberusPose& pose : poses)
    if (pose.valid_from <= time) cerberus_pose_evaluate(&pose, time, &pan, nullptr);
  return pan;
}

GST_START_TEST(the_start_pose_is_published_before_the_first_frame) {
  Rig rig("start-pan=20 start-tilt=-5 latency=80000000");
  const CerberusPose pose = rig.next_pose();
  fail_unless_equals_string(pose.head, "head");
  fail_unless_equals_float(pose.pan, 20);
  fail_unless(std::fabs(pose.tilt + 5) < 1e-9);
  fail_unless_equals_uint64(pose.valid_from, 0);
  fail_unless_equals_uint64(pose.valid_until, 80 * GST_MSECOND);
  fail_unless(pose.settled && !pose.moving);
}
GST_END_TEST

GST_START_TEST(each_frame_is_answered_with_the_poses_until_its_time_plus_the_latency) {
  Rig rig;
  GstClockTime published = rig.next_pose().valid_until;
  for (int k = 0; k < 50; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    add(buffer, k < 25 ? CERBERUS_FUSION_TURN_RIGHT : CERBERUS_FUSION_TURN_LEFT);
    rig.push(buffer);
    const auto poses = rig.poses();
    fail_if(poses.empty());
    for (const CerberusPose& pose : poses) {
      fail_unless_equals_uint64(pose.valid_from, published);  // without a gap
      published = pose.valid_until;
    }
    fail_unless_equals_uint64(published, k * kFrame + 60 * GST_MSECOND);
  }
}
GST_END_TEST

// Position, speed and acceleration of both axes: where a pose ends, the next one begins.
GST_START_TEST(poses_meet) {
  Rig rig;
  fail_unless(rig.call("move-to", 50, 20));
  CerberusPose last = rig.next_pose();
  for (const CerberusPose& pose : act(rig, CERBERUS_FUSION_HOLD, 0, 75)) {
    double pan = NAN, tilt = NAN;
    fail_unless(cerberus_pose_evaluate(&last, pose.valid_from, &pan, &tilt));
    fail_unless(std::fabs(pan - pose.pan) < 1e-9, "pan at %g: %g", pose.pan, pan);
    fail_unless(std::fabs(tilt - pose.tilt) < 1e-9, "tilt at %g: %g", pose.tilt, tilt);
    last = pose;
  }
  fail_unless(std::fabs(last.pan - 50) < 1e-9 && std::fabs(last.tilt - 20) < 1e-9);
}
GST_END_TEST

GST_START_TEST(slow_frames_are_answered_until_the_next_one) {
  Rig rig;
  for (int k = 0; k < 5; ++k) {
    rig.push(frame_at(k * GST_SECOND / 2, GST_SECOND / 2));
    fail_unless_equals_uint64(rig.poses().back().valid_until, (k + 1) * GST_SECOND / 2);
  }
}
GST_END_TEST

// 40 degrees a second after 1/15 s at 600: from the latency on 40 (t - 0.06 - 1/30).
GST_START_TEST(turn_turns_at_full_speed_as_far_as_the_stop) {
  Rig rig("pan-max=60 max-speed=40");
  auto poses = act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 60);
  fail_unless(pan_at(poses, 60 * GST_MSECOND) == 0);
  fail_unless(std::fabs(pan_at(poses, GST_SECOND) - 40 * (1 - 0.06 - 1 / 30.0)) < 1e-6);
  fail_unless(std::fabs(pan_at(poses, 60 * kFrame) - 60) < 1e-9);
  for (const CerberusPose& pose : poses) fail_unless(pose.pan <= 60 && pose.pan_speed <= 40 + 1e-9);
  fail_unless(poses.back().settled);
  const std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "turning limited");
}
GST_END_TEST

GST_START_TEST(search_sweeps_from_edge_to_edge) {
  Rig rig;
  const auto poses = act(rig, CERBERUS_FUSION_SEARCH, 0, 200, -30, 40);
  double left = 0, right = 0;
  int reversals = 0;
  for (std::size_t k = 1; k < poses.size(); ++k) {
    left = std::min(left, poses[k].pan);
    right = std::max(right, poses[k].pan);
    reversals += poses[k].pan_speed * poses[k - 1].pan_speed < 0 ||
                 (poses[k - 1].pan_speed != 0 && poses[k].pan_speed == 0);
  }
  fail_unless(std::fabs(left + 30) < 0.1 && std::fabs(right - 40) < 0.1, "%g %g", left, right);
  fail_unless(reversals >= 3 && reversals <= 10, "%d", reversals);
}
GST_END_TEST

GST_START_TEST(zero_returns_and_hold_stays) {
  Rig rig("start-pan=50 start-tilt=10");
  auto poses = act(rig, CERBERUS_FUSION_HOLD, 0, 25);
  fail_unless(std::fabs(pan_at(poses, GST_SECOND) - 50) < 1e-9);
  poses = act(rig, CERBERUS_FUSION_ZERO, 25, 75);
  fail_unless(std::fabs(poses.back().pan) < 1e-9 && std::fabs(poses.back().tilt) < 1e-9);
}
GST_END_TEST

// A person who stands at a bearing of 25 degrees, seen by the turning head, with the poses published for it.
GST_START_TEST(a_target_comes_into_the_middle_and_the_head_rests) {
  Rig rig;
  std::vector<CerberusPose> poses = rig.poses();
  for (int k = 0; k < 75; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    add(buffer, CERBERUS_FUSION_TRACK, 7);
    add(buffer, person(7, 25 - pan_at(poses, k * kFrame)));
    add(buffer, person(8, -20));
    rig.push(buffer);
    for (const CerberusPose& pose : rig.poses()) poses.push_back(pose);
  }
  fail_unless(std::fabs(poses.back().pan - 25) <= 0.7, "%g", poses.back().pan);
  fail_unless(poses.back().settled);
  const std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "tracking");
}
GST_END_TEST

GST_START_TEST(the_pose_on_a_frame_wins_if_it_is_this_heads) {
  for (const char* head : {"head", "another"}) {
    Rig rig;
    for (int k = 0; k < 50; ++k) {
      GstBuffer* buffer = frame_at(k * kFrame);
      CerberusPose pose;
      cerberus_pose_init(&pose);
      cerberus_pose_set_head(&pose, head);
      pose.pan = 30;
      cerberus_buffer_set_pose(buffer, &pose);
      add(buffer, CERBERUS_FUSION_TRACK, 7);
      add(buffer, person(7, 0));
      rig.push(buffer);
    }
    const double pan = rig.poses().back().pan;
    fail_unless(std::fabs(pan - (g_str_equal(head, "head") ? 30 : 0)) <= 0.7, "%s: %g", head, pan);
  }
}
GST_END_TEST

GST_START_TEST(a_target_that_is_not_on_the_frame_is_not_followed) {
  Rig rig;
  for (int k = 0; k < 25; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    add(buffer, CERBERUS_FUSION_TRACK, 9);
    add(buffer, person(7, 20));
    rig.push(buffer);
  }
  fail_unless(rig.poses().back().pan == 0);
}
GST_END_TEST

GST_START_TEST(without_fusion_tracks_are_followed_and_later_the_head_returns) {
  Rig rig("return-delay=1000000000");
  std::vector<CerberusPose> poses = rig.poses();
  for (int k = 0; k < 150; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    if (k < 50) add(buffer, person(3, 20 - pan_at(poses, k * kFrame)));
    rig.push(buffer);
    for (const CerberusPose& pose : rig.poses()) poses.push_back(pose);
  }
  fail_unless(std::fabs(pan_at(poses, 2 * GST_SECOND) - 20) <= 0.7);
  fail_unless(std::fabs(pan_at(poses, 2900 * GST_MSECOND) - 20) <= 0.7);  // return-delay
  fail_unless(std::fabs(poses.back().pan) < 1e-9);
  const std::string states = rig.states();
  // Held twice, for two reasons: the track was here a moment ago; then there is none, but not for long enough.
  fail_unless_equals_string(states.c_str(), "tracking holding holding zeroing");
}
GST_END_TEST

GST_START_TEST(the_first_target_is_a_choice_and_then_kept) {
  const Person near{
      .id = 1, .x = 20, .y = 100, .width = 20, .height = 60, .age = 3 * GST_SECOND, .distance = 2};
  const Person large{
      .id = 2, .x = 220, .y = 60, .width = 60, .height = 120, .age = 2 * GST_SECOND, .distance = 9};
  const Person young{.id = 3, .x = 150, .y = 0, .width = 20, .height = 60, .age = GST_SECOND, .distance = 5};
  for (const auto& [choice, id] :
       {std::pair("nearest", "1"), std::pair("largest", "2"), std::pair("newest", "3")}) {
    Rig rig(std::string("target=") + choice);
    GstBuffer* buffer = frame_at(0);
    for (const Person& person : {near, large, young}) add(buffer, person);
    rig.push(buffer);
    const auto messages = rig.messages();
    fail_unless_equals_int(messages.size(), 1);
    fail_unless(messages[0].reason.ends_with(std::string("track ") + id), "%s", messages[0].reason.c_str());
    // A better candidate does not replace the track that is followed.
    buffer = frame_at(kFrame);
    for (const Person& person : {near, large, young}) add(buffer, person);
    add(buffer, Person{.id = 4, .x = 0, .y = 0, .width = 300, .height = 200, .age = 0, .distance = 1});
    rig.push(buffer);
    fail_unless(rig.messages().empty());
  }
}
GST_END_TEST

GST_START_TEST(a_frame_that_is_not_newer_is_dropped) {
  Rig rig;
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 5, 1);
  for (const int k : {5, 4, 0}) fail_unless(act(rig, CERBERUS_FUSION_TURN_LEFT, k, 1).empty());
  fail_if(act(rig, CERBERUS_FUSION_TURN_LEFT, 6, 1).empty());
}
GST_END_TEST

// One frame is stamped three hours off; the ones behind it are obeyed as if there were none, and each is answered until
// its own time plus the latency.
GST_START_TEST(a_single_time_stamp_that_is_far_off_does_not_blind_the_head) {
  Rig rig;
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 100000, 10);
  rig.messages();
  int at = 100010;
  for (const GstClockTimeDiff off : {3 * 3600 * GST_SECOND, -3600 * GST_SECOND}) {
    GstBuffer* buffer = frame_at(at * kFrame + off);
    add(buffer, CERBERUS_FUSION_TURN_RIGHT);
    rig.push(buffer);
    rig.poses();
    for (int k = at + 1; k < at + 20; ++k) {
      const auto poses = act(rig, k < at + 10 ? CERBERUS_FUSION_TURN_LEFT : CERBERUS_FUSION_TURN_RIGHT, k, 1);
      fail_if(poses.empty(), "frame %d", k);
      fail_unless_equals_uint64(poses.back().valid_until, k * kFrame + 60 * GST_MSECOND);
    }
    fail_unless(rig.states() == "turning turning");
    at += 20;
  }
}
GST_END_TEST

// The times of a recording that begins anew without a word: from the third frame on the head obeys.
GST_START_TEST(times_that_have_gone_back_blind_the_head_for_two_frames) {
  Rig rig;
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 100000, 10);
  rig.messages();
  fail_unless(act(rig, CERBERUS_FUSION_TURN_LEFT, 0, 2).empty());
  fail_if(act(rig, CERBERUS_FUSION_TURN_LEFT, 2, 1).empty());
  fail_unless(rig.states() == "turning");
}
GST_END_TEST

GST_START_TEST(frames_without_time_stamps_count_at_the_frame_rate) {
  Rig rig;
  for (int k = 0; k < 26; ++k) {
    GstBuffer* buffer = frame_at(GST_CLOCK_TIME_NONE, GST_CLOCK_TIME_NONE);
    add(buffer, CERBERUS_FUSION_TURN_RIGHT);
    rig.push(buffer);
  }
  fail_unless_equals_uint64(rig.poses().back().valid_until, 25 * kFrame + 60 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(a_gap_keeps_the_pace) {
  Rig rig;
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 1);
  fail_unless(gst_harness_push_event(rig.harness, gst_event_new_gap(kFrame, kFrame)));
  fail_unless_equals_uint64(rig.poses().back().valid_until, kFrame + 60 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(a_frame_may_come_in_the_middle_of_a_gap) {
  // Its command comes after the watchdog's, which was given for 1.16 s.
  Rig rig("watchdog-timeout=200000000 max-speed=40");
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 25);
  fail_unless(gst_harness_push_event(rig.harness, gst_event_new_gap(GST_SECOND, 180 * GST_MSECOND)));
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 26, 30);
  fail_unless(rig.states().find("fault") == std::string::npos);
}
GST_END_TEST

GST_START_TEST(when_frames_stay_away_the_head_has_stopped_meanwhile) {
  for (const bool gap : {false, true}) {  // that none will come
    Rig rig("watchdog-timeout=200000000 max-speed=40");
    act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 25);
    if (gap) fail_unless(gst_harness_push_event(rig.harness, gst_event_new_gap(25 * kFrame, 50 * kFrame)));
    const auto poses = act(rig, CERBERUS_FUSION_HOLD, 75, 1);  // 2 s later
    // The stop is commanded 0.2 s after the frame at 0.96 s, at 1.16: braking begins at 1.22 and takes 40^2 / 1200
    // degrees.
    const double stopped = 40 * (1.22 - 0.06 - 1 / 30.0) + 40 * 40 / 1200.0;
    fail_unless(std::fabs(poses.back().pan - stopped) < 1e-6, "%g %g", poses.back().pan, stopped);
  }
}
GST_END_TEST

GST_START_TEST(when_frames_stay_away_an_order_by_hand_is_over) {
  Rig rig("watchdog-timeout=200000000 max-speed=40");
  fail_unless(rig.call("move-to", 150, 0));
  act(rig, CERBERUS_FUSION_TURN_LEFT, 0, 25);
  rig.messages();
  const auto poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 75, 25);
  const double stopped = 40 * (1.22 - 0.06 - 1 / 30.0) + 40 * 40 / 1200.0;  // as above
  fail_unless(std::fabs(poses.back().pan - stopped) < 1e-6, "%g %g", poses.back().pan, stopped);
  const std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "stopped manual");
}
GST_END_TEST

std::string trajectory(const char* properties) {
  Rig rig(properties);
  std::string text;
  std::vector<CerberusPose> poses = rig.poses();
  for (int k = 0; k < 100; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    add(buffer, person(1, 40 * std::sin(k * 0.1) - pan_at(poses, k * kFrame)));
    rig.push(buffer);
    for (const CerberusPose& pose : rig.poses()) {
      poses.push_back(pose);
      gchar* line = g_strdup_printf("%a %a %a %" G_GUINT64_FORMAT "\n", pose.pan, pose.tilt, pose.pan_speed,
                                    pose.valid_until);
      text += line;
      g_free(line);
    }
  }
  return text;
}

GST_START_TEST(equal_seeds_give_equal_ways) {
  constexpr const char* kHead = "noise=0.3 backlash=0.5 step-size=0.1 seed=5";
  const std::string first = trajectory(kHead);
  fail_unless(first == trajectory(kHead));
  fail_if(first == trajectory("noise=0.3 backlash=0.5 step-size=0.1 seed=6"));
  fail_if(first == trajectory("backlash=0.5 step-size=0.1 seed=5"));
}
GST_END_TEST

GST_START_TEST(the_application_may_take_over_and_give_back) {
  Rig rig;
  fail_unless(rig.call("move-to", 30, 10));
  auto poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 0, 50);
  fail_unless(std::fabs(poses.back().pan - 30) < 1e-9 && std::fabs(poses.back().tilt - 10) < 1e-9);
  fail_unless(rig.call("move-by", -40, -20));
  poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 50, 50);
  fail_unless(std::fabs(poses.back().pan + 10) < 1e-9 && std::fabs(poses.back().tilt + 10) < 1e-9);
  fail_unless(rig.call("home"));
  poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 100, 50);
  fail_unless(std::fabs(poses.back().pan) < 1e-9 && std::fabs(poses.back().tilt) < 1e-9);
  fail_unless(rig.call("auto"));
  poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 150, 25);
  fail_unless(poses.back().pan_speed < -39);
  fail_unless(rig.call("stop"));
  poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 175, 25);
  fail_unless(poses.back().settled);
  const std::string states = rig.states();
  fail_unless_equals_string(states.c_str(), "manual holding turning manual");
}
GST_END_TEST

GST_START_TEST(what_the_application_asks_for_stays_within_the_limits) {
  Rig rig("pan-max=50");
  fail_if(rig.call("move-to", NAN, 0));
  fail_if(rig.call("move-by", 0, INFINITY));
  fail_unless(rig.messages().empty());
  fail_unless(rig.call("move-to", 500, -500));
  const auto poses = act(rig, CERBERUS_FUSION_HOLD, 0, 75);
  fail_unless(std::fabs(poses.back().pan - 50) < 1e-9 && std::fabs(poses.back().tilt + 45) < 1e-9);
  fail_unless(rig.messages()[0].reason.find("limit") != std::string::npos);
  gst_element_set_state(rig.element, GST_STATE_NULL);
  fail_if(rig.call("move-to", 0, 0));  // there is no head
  fail_if(rig.call("stop"));
}
GST_END_TEST

GST_START_TEST(the_head_stops_at_the_end_in_pause_and_on_a_flush) {
  for (const int what : {0, 1, 2})
    assert_said("stopped", Answers::on_a_thread, [what] {
      Pipe record;
      Rig rig(scripted("record " + record.writer()));
      act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 3);
      if (what == 0) fail_unless(gst_harness_push_event(rig.harness, gst_event_new_eos()));
      if (what == 1) gst_element_set_state(rig.element, GST_STATE_PAUSED);
      if (what == 2) fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_start()));
      fail_unless(record.line().starts_with("open"));
      for (int k = 0; k < 3; ++k) fail_unless(record.line().starts_with("command"));
      fail_unless(record.line().starts_with("stop"));
      const auto messages = rig.messages();
      gst_element_set_state(rig.element, GST_STATE_NULL);
      fail_unless(record.line().starts_with("close"));
      return messages.back().state;
    });
}
GST_END_TEST

// EOS is a latch: nothing moves the head until a flush begins the stream anew, in PAUSED or in PLAYING.
GST_START_TEST(after_the_end_of_the_stream_nothing_moves_the_head) {
  for (const GstState state : {GST_STATE_PLAYING, GST_STATE_PAUSED}) {
    Rig rig("max-speed=20");
    fail_unless(rig.call("move-to", 90, 0));
    const double before = act(rig, CERBERUS_FUSION_HOLD, 0, 10).back().pan;
    fail_unless(before > 0 && before < 20);
    fail_unless(gst_harness_push_event(rig.harness, gst_event_new_eos()));
    rig.messages();
    fail_if(rig.call("move-to", 60, 0));
    fail_if(rig.call("move-by", 60, 0));
    fail_if(rig.call("home"));
    fail_if(rig.follow(3));
    gst_element_set_state(rig.element, GST_STATE_PAUSED);
    fail_if(rig.call("move-to", 60, 0));
    gst_element_set_state(rig.element, GST_STATE_PLAYING);
    fail_if(rig.call("move-to", 60, 0));
    fail_unless(rig.messages().empty());

    gst_element_set_state(rig.element, state);
    fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_start()));
    fail_unless(gst_harness_push_event(rig.harness, gst_event_new_flush_stop(TRUE)));
    gst_element_set_state(rig.element, GST_STATE_PLAYING);
    push_segment(rig.harness);
    // The order is over, and the head still in the application's hand.
    auto poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 0, 25);
    const double here = poses.back().pan;
    fail_unless(poses.back().settled && here >= before && here < before + 5, "%g %g", before, here);
    fail_unless(rig.call("move-to", 30, 0));
    poses = act(rig, CERBERUS_FUSION_TURN_LEFT, 25, 75);
    fail_unless(std::fabs(poses.back().pan - 30) < 1e-9, "%g", poses.back().pan);
    fail_unless(rig.call("auto"));
    fail_unless(act(rig, CERBERUS_FUSION_TURN_LEFT, 100, 25).back().pan_speed < 0);
  }
}
GST_END_TEST

GST_START_TEST(after_a_flush_time_begins_anew_and_the_head_goes_on_from_where_it_is) {
  Rig rig("max-speed=40");
  const double before = act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 50).back().pan;
  push_flush(rig.harness);
  const CerberusPose start = rig.next_pose();
  fail_unless_equals_uint64(start.valid_from, 0);
  fail_unless(start.pan >= before);
  const auto poses = act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 25);
  fail_unless_equals_uint64(poses.back().valid_until, 24 * kFrame + 60 * GST_MSECOND);
  fail_unless(poses.back().pan > before + 30);
  fail_unless(rig.states().find("fault") == std::string::npos);
}
GST_END_TEST

GST_START_TEST(properties_changed_while_playing_count_from_the_next_frame) {
  Rig rig;
  act(rig, CERBERUS_FUSION_TURN_RIGHT, 0, 10);
  g_object_set(rig.element, "max-speed", 20.0, "turn-speed", 10.0, nullptr);
  fail_unless(std::fabs(act(rig, CERBERUS_FUSION_TURN_RIGHT, 10, 10).back().pan_speed - 20) < 1e-6);
  fail_unless(std::fabs(act(rig, CERBERUS_FUSION_ZERO, 20, 10).back().pan_speed + 10) < 1e-6);
}
GST_END_TEST

GST_START_TEST(a_new_picture_size_changes_the_lens) {
  Rig rig;
  gst_harness_set_src_caps_str(rig.harness, "video/x-raw,format=GRAY8,width=640,height=480,framerate=25/1");
  for (int k = 0; k < 50; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    add(buffer, CERBERUS_FUSION_TRACK, 1);
    add(buffer, Person{.id = 1, .x = 310, .y = 220, .width = 20, .height = 40});  // the middle now
    rig.push(buffer);
  }
  fail_unless(std::fabs(rig.poses().back().pan) < 1e-9);
}
GST_END_TEST

GST_START_TEST(metas_of_other_elements_do_no_harm) {
  Rig rig;
  for (int k = 0; k < 40; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    CerberusFusion fusion;
    cerberus_fusion_init(&fusion);
    fusion.action = static_cast<CerberusFusionAction>(k % 8);
    fusion.target = 1;
    fusion.sector_from = k % 2 ? NAN : -1e300;
    fusion.sector_to = INFINITY;
    cerberus_buffer_set_fusion(buffer, &fusion);
    CerberusPose pose;
    cerberus_pose_init(&pose);
    pose.pan = k % 2 ? NAN : 1e300;
    pose.tilt = -INFINITY;
    cerberus_buffer_set_pose(buffer, &pose);
    add(buffer, Person{.id = 1, .x = k % 3 ? NAN : 1e300, .y = -1e300, .width = INFINITY, .height = 0});
    rig.push(buffer);
    for (const CerberusPose& pose : rig.poses())
      fail_unless(std::fabs(pose.pan) <= 170 && std::fabs(pose.tilt) <= 45);
  }
}
GST_END_TEST

Suite* pantiltsink_suite() {
  Suite* suite = suite_create("pantiltsink");
  TCase* tests = tcase_create("not live");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, the_start_pose_is_published_before_the_first_frame);
  tcase_add_test(tests, each_frame_is_answered_with_the_poses_until_its_time_plus_the_latency);
  tcase_add_test(tests, poses_meet);
  tcase_add_test(tests, slow_frames_are_answered_until_the_next_one);
  tcase_add_test(tests, turn_turns_at_full_speed_as_far_as_the_stop);
  tcase_add_test(tests, search_sweeps_from_edge_to_edge);
  tcase_add_test(tests, zero_returns_and_hold_stays);
  tcase_add_test(tests, a_target_comes_into_the_middle_and_the_head_rests);
  tcase_add_test(tests, the_pose_on_a_frame_wins_if_it_is_this_heads);
  tcase_add_test(tests, a_target_that_is_not_on_the_frame_is_not_followed);
  tcase_add_test(tests, without_fusion_tracks_are_followed_and_later_the_head_returns);
  tcase_add_test(tests, the_first_target_is_a_choice_and_then_kept);
  tcase_add_test(tests, a_frame_that_is_not_newer_is_dropped);
  tcase_add_test(tests, a_single_time_stamp_that_is_far_off_does_not_blind_the_head);
  tcase_add_test(tests, times_that_have_gone_back_blind_the_head_for_two_frames);
  tcase_add_test(tests, frames_without_time_stamps_count_at_the_frame_rate);
  tcase_add_test(tests, a_gap_keeps_the_pace);
  tcase_add_test(tests, a_frame_may_come_in_the_middle_of_a_gap);
  tcase_add_test(tests, when_frames_stay_away_the_head_has_stopped_meanwhile);
  tcase_add_test(tests, when_frames_stay_away_an_order_by_hand_is_over);
  tcase_add_test(tests, equal_seeds_give_equal_ways);
  tcase_add_test(tests, the_application_may_take_over_and_give_back);
  tcase_add_test(tests, what_the_application_asks_for_stays_within_the_limits);
  tcase_add_test(tests, the_head_stops_at_the_end_in_pause_and_on_a_flush);
  tcase_add_test(tests, after_the_end_of_the_stream_nothing_moves_the_head);
  tcase_add_test(tests, after_a_flush_time_begins_anew_and_the_head_goes_on_from_where_it_is);
  tcase_add_test(tests, properties_changed_while_playing_count_from_the_next_frame);
  tcase_add_test(tests, a_new_picture_size_changes_the_lens);
  tcase_add_test(tests, metas_of_other_elements_do_no_harm);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(pantiltsink);
