// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink executes a fusion decision that comes between two frames as if a frame carried it, and nothing else.
#include <functional>

#include "head_rig.h"

namespace {

using namespace head_rig;

constexpr GstClockTime kMs = GST_MSECOND;

CerberusFusion decision(CerberusFusionAction action, GstClockTime decided, guint target = 0) {
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.action = action;
  fusion.target = target;
  fusion.decided = decided;
  return fusion;
}

void show(Rig& rig, GstClockTime pts, const CerberusFusion& fusion) {
  GstBuffer* frame = frame_at(pts);
  cerberus_buffer_set_fusion(frame, &fusion);
  rig.push(frame);
}

// The states that are reported after a decision between two frames.
std::string states_after(Rig& rig, const CerberusFusion& fusion, const char* head = "head") {
  rig.messages();
  gst_harness_push_event(rig.harness, fusion_event(head, fusion));
  return rig.states();
}

void set_time(Rig& rig, GstClockTime now) {
  gst_harness_set_time(rig.harness, now);
}

// A live head that holds because of the decision on a frame, at 100 ms.
void begin(Rig& rig) {
  set_time(rig, 100 * kMs);
  show(rig, 60 * kMs, decision(CERBERUS_FUSION_HOLD, 90 * kMs));
}

}  // namespace

GST_START_TEST(it_is_obeyed_at_once) {
  for (const char* head : {"head", ""}) {
    Rig rig("watchdog-timeout=0", Source::live);
    begin(rig);
    rig.poses();
    fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_RIGHT, 95 * kMs), head) == "turning");
    while (rig.next_pose().valid_until == GST_CLOCK_TIME_NONE) continue;  // a plan with an end: it will move
  }
}
GST_END_TEST

// They come late, through queues, and would turn the head back until the next one.
GST_START_TEST(a_frame_that_was_decided_before_does_not_take_it_back) {
  Rig rig("watchdog-timeout=0", Source::live);
  begin(rig);
  states_after(rig, decision(CERBERUS_FUSION_TURN_RIGHT, 95 * kMs));
  show(rig, 61 * kMs, decision(CERBERUS_FUSION_HOLD, 94 * kMs));
  fail_unless(rig.states().empty());
  fail_unless(
      states_after(rig, decision(CERBERUS_FUSION_TURN_LEFT, 93 * kMs)).empty());  // nor does an older event
  show(rig, 62 * kMs, decision(CERBERUS_FUSION_HOLD, 95 * kMs));
  fail_unless(rig.states() == "holding");
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_LEFT, 95 * kMs))
                  .empty());  // the frame's decision is as new
}
GST_END_TEST

GST_START_TEST(events_of_another_head_are_ignored) {
  Rig rig("watchdog-timeout=0", Source::live);
  begin(rig);
  const CerberusFusion right = decision(CERBERUS_FUSION_TURN_RIGHT, 95 * kMs);
  fail_unless(states_after(rig, right, "tail").empty());
  for (const int action : {257, -1, 6}) {  // none that there is; the first is 1 in a byte
    GstEvent* event = fusion_event("head", right);
    gst_structure_set(gst_event_writable_structure(event), "action", CERBERUS_TYPE_FUSION_ACTION, action,
                      nullptr);
    gst_harness_push_event(rig.harness, event);
    fail_unless(rig.states().empty());
  }
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_RIGHT, 300 * kMs)).empty());  // not yet
  set_time(rig, 1200 * kMs);
  fail_unless(states_after(rig, right).empty());  // long ago
  set_time(rig, 1210 * kMs);
  for (const char* name : {"cerberus-fusion", "something"})
    gst_harness_push_event(
        rig.harness, gst_event_new_custom(GST_EVENT_CUSTOM_DOWNSTREAM_OOB, gst_structure_new_empty(name)));
  fail_unless(rig.states().empty());
  // There is no fusion here: the head uses its own rules.
  rig.push(frame_at(1200 * kMs));
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_RIGHT, 1210 * kMs)).empty());
}
GST_END_TEST

GST_START_TEST(a_head_that_ignores_frames_ignores_events) {
  const CerberusFusion right = decision(CERBERUS_FUSION_TURN_RIGHT, 110 * kMs);
  const struct {
    const char* what;
    std::function<void(Rig&)> stop;
  } cases[] = {{"paused", [](Rig& rig) { gst_element_set_state(rig.element, GST_STATE_PAUSED); }},
               {"at the end", [](Rig& rig) { gst_harness_push_event(rig.harness, gst_event_new_eos()); }},
               {"under manual control", [](Rig& rig) { rig.call("stop"); }},
               {"flushed", [](Rig& rig) {
                  gst_harness_push_event(rig.harness, gst_event_new_flush_start());
                  gst_harness_push_event(rig.harness, gst_event_new_flush_stop(FALSE));
                }}};
  for (const auto& c : cases) {
    Rig rig("watchdog-timeout=0", Source::live);
    begin(rig);
    set_time(rig, 110 * kMs);
    c.stop(rig);
    fail_unless(states_after(rig, right).empty(), "%s", c.what);
  }
  Rig stored("watchdog-timeout=0");
  begin(stored);
  fail_unless(states_after(stored, decision(CERBERUS_FUSION_TURN_RIGHT, 95 * kMs)).empty());
}
GST_END_TEST

// Decisions that continue do not keep the head moving when the frames have stopped.
GST_START_TEST(frames_alone_keep_the_watchdog_quiet) {
  Rig rig("watchdog-timeout=200000000", Source::live);
  begin(rig);
  set_time(rig, 250 * kMs);
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_RIGHT, 250 * kMs)) == "turning");
  GstClockTime now = 0;
  for (bool stopped = false; !stopped;) {
    now = rig.crank();
    fail_unless(now < GST_SECOND);
    stopped = rig.states() == "stopped";
  }
  fail_unless(now >= 300 * kMs);
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_LEFT, now)).empty());
}
GST_END_TEST

GST_START_TEST(limits_hold) {
  Rig rig("watchdog-timeout=0 pan-min=-10 pan-max=10", Source::live);
  begin(rig);
  states_after(rig, decision(CERBERUS_FUSION_TURN_RIGHT, 95 * kMs));
  double most = 0;
  while (rig.crank() < 3 * GST_SECOND && most < 9.99)
    for (const CerberusPose& pose : rig.poses()) most = std::max(most, pose.pan);
  fail_unless(most > 9.9 && most < 10.0001, "it came to %g", most);
}
GST_END_TEST

GST_START_TEST(a_target_is_followed_with_frames) {
  Rig rig("watchdog-timeout=0", Source::live);
  set_time(rig, 100 * kMs);
  GstBuffer* frame = frame_at(60 * kMs);
  add(frame, person(3, 10));
  add(frame, person(4, -10));
  const CerberusFusion hold = decision(CERBERUS_FUSION_HOLD, 90 * kMs);
  cerberus_buffer_set_fusion(frame, &hold);
  GstBuffer* next = gst_buffer_copy(frame);
  GST_BUFFER_PTS(next) = 61 * kMs;
  GstBuffer* last = gst_buffer_copy(frame);
  GST_BUFFER_PTS(last) = 62 * kMs;
  rig.push(frame);
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TRACK, 95 * kMs, 4)).empty());
  rig.push(next);  // an older decision: the event's target is looked up among this frame's tracks
  const auto messages = rig.messages();
  fail_unless(messages.size() == 1 && messages[0].state == "tracking", "%zu", messages.size());
  fail_unless(messages[0].reason.find("track 4") != std::string::npos, "%s", messages[0].reason.c_str());

  fail_unless(rig.follow(3));
  rig.push(last);
  fail_unless(states_after(rig, decision(CERBERUS_FUSION_TURN_LEFT, 97 * kMs))
                  .empty());  // the chosen track is on the frame
}
GST_END_TEST

static Suite* pantiltsink_between_suite() {
  watch_library_log();
  Suite* s = suite_create("pantiltsink between two frames");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, it_is_obeyed_at_once);
  tcase_add_test(tc, a_frame_that_was_decided_before_does_not_take_it_back);
  tcase_add_test(tc, events_of_another_head_are_ignored);
  tcase_add_test(tc, a_head_that_ignores_frames_ignores_events);
  tcase_add_test(tc, frames_alone_keep_the_watchdog_quiet);
  tcase_add_test(tc, limits_hold);
  tcase_add_test(tc, a_target_is_followed_with_frames);
  return s;
}

GST_CHECK_MAIN(pantiltsink_between)
