// SPDX-License-Identifier: LGPL-2.1-or-later
// Not live, virtualptz makes a frame when the pose for its time is known: which pose it waits for, and for how long.
#include <chrono>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "promises.h"
#include "ptz_rig.h"

using namespace ptz_rig;

namespace {

// A push in a thread of its own, for frames that wait.
struct Push {
  GstFlowReturn flow = GST_FLOW_OK;
  std::thread thread;
  Push(Ptz& ptz, int number)
      : thread([this, &ptz, number] { flow = gst_harness_push(ptz.h.get(), noise(ptz.in, number)); }) {}
  GstFlowReturn result() {
    thread.join();
    return flow;
  }
};

}  // namespace

GST_START_TEST(not_live_a_frame_waits_for_its_pose) {
  Ptz ptz(kLine, false);
  ptz.frame_shows(0, 80, 60);
  for (int number = 1; number < 20; ++number) {
    // An earlier pose ends no wait.
    send(ptz.h.get(), pose(0, 0, (number - 1) * 40 * GST_MSECOND, (number * 40 - 1) * GST_MSECOND));
    Push push(ptz, number);
    send(ptz.h.get(),
         pose(number % 2 ? kForty : 0, 0, (number * 40 - 1) * GST_MSECOND, number * 40 * GST_MSECOND));
    fail_unless_equals_int(push.result(), GST_FLOW_OK);
    ptz.shows(gst_harness_pull(ptz.h.get()), number, number % 2 ? 120 : 80, 60);
  }
}
GST_END_TEST

// A head without frames publishes nothing, and publishes poses through a gap when it receives a GAP event.
struct Silent {
  GstHarness* h;
  std::vector<std::pair<GstClockTime, GstClockTime>> gaps;
  explicit Silent(GstHarness* harness) : h(harness) {
    gst_pad_add_probe(
        h->sinkpad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
        [](GstPad*, GstPadProbeInfo* info, gpointer data) {
          GstEvent* event = GST_PAD_PROBE_INFO_EVENT(info);
          if (GST_EVENT_TYPE(event) != GST_EVENT_GAP) return GST_PAD_PROBE_OK;
          auto* self = static_cast<Silent*>(data);
          auto& gap = self->gaps.emplace_back();
          gst_event_parse_gap(event, &gap.first, &gap.second);
          send(self->h, pose(kForty, 0, gap.first, gap.first + gap.second));
          return GST_PAD_PROBE_OK;
        },
        this, nullptr);
  }
};

GST_START_TEST(missing_frames_are_announced_downstream) {
  Ptz ptz(kLine + "lockstep-timeout=1000000", false);
  Silent silent(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  ptz.frame_shows(5, 120, 60);
  send(ptz.h.get(), pose(0, 0, 200 * GST_MSECOND, 260 * GST_MSECOND));
  ptz.frame_shows(6, 80, 60);
  ptz.frame_shows(8, 120, 60);
  const decltype(silent.gaps) missing = {{40 * GST_MSECOND, 160 * GST_MSECOND},
                                         {280 * GST_MSECOND, 40 * GST_MSECOND}};
  fail_unless(silent.gaps == missing, "%zu gaps", silent.gaps.size());
}
GST_END_TEST

// The head does not learn of a frame that was lost on its way: the next one is not shown before the gap is.
GST_START_TEST(a_frame_that_is_lost_behind_it_becomes_a_gap) {
  Ptz ptz(kLine + "lockstep-timeout=60000000000", false);
  Silent silent(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  send(ptz.h.get(), pose(0, 0, 0, 40 * GST_MSECOND));
  ptz.frame_shows(1, 80, 60);  // is lost
  fail_unless(silent.gaps.empty());
  ptz.frame_shows(2, 120, 60);
  const decltype(silent.gaps) missing = {{40 * GST_MSECOND, 40 * GST_MSECOND}};
  fail_unless(silent.gaps == missing, "%zu gaps", silent.gaps.size());
}
GST_END_TEST

GST_START_TEST(a_stream_without_a_rate_is_full_of_gaps) {
  Ptz ptz(kLine + "lockstep-timeout=1000000", false);
  Silent silent(ptz.h.get());
  gst_harness_set_src_caps_str(
      ptz.h.get(), "video/x-raw,format=I420,width=320,height=240,framerate=0/1,interlace-mode=progressive");
  for (const int number : {0, 1, 3}) {
    GstBuffer* frame = noise(ptz.in, number);
    GST_BUFFER_DURATION(frame) = GST_CLOCK_TIME_NONE;
    fail_unless_equals_int(gst_harness_push(ptz.h.get(), frame), GST_FLOW_OK);
    ptz.shows(gst_harness_pull(ptz.h.get()), number, number ? 120 : 80, 60);
  }
  fail_unless_equals_int(silent.gaps.size(), 2);
  // It begins when the last frame is over, and that one is not of no time at all.
  fail_unless_equals_uint64(silent.gaps[1].first, 40 * GST_MSECOND + 1);
  fail_unless_equals_uint64(silent.gaps[1].first + silent.gaps[1].second, 120 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(a_segment_may_begin_with_a_gap) {
  Ptz ptz(kLine + "lockstep-timeout=1000000", false);
  Silent silent(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  // Running time goes on at 1 s: the first frame's end at 40 ms lies before.
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = segment.time = 10 * GST_SECOND;
  segment.base = GST_SECOND;
  gst_harness_push_event(ptz.h.get(), gst_event_new_segment(&segment));
  GstBuffer* frame = noise(ptz.in, 1);
  GST_BUFFER_PTS(frame) = 10 * GST_SECOND + 80 * GST_MSECOND;
  send(ptz.h.get(), pose(0, 0, GST_SECOND, GST_SECOND + 60 * GST_MSECOND));
  gst_harness_push(ptz.h.get(), frame);
  const decltype(silent.gaps) missing = {{10 * GST_SECOND, 80 * GST_MSECOND}};
  fail_unless(silent.gaps == missing, "%zu gaps", silent.gaps.size());
}
GST_END_TEST

GST_START_TEST(of_two_poses_that_meet_the_earlier_counts_in_lockstep) {
  // The later one may or may not have come in time: the result must not depend on it.
  Ptz ptz(kLine, false);
  ptz.frame_shows(0, 80, 60);
  CerberusPose moving = pose(0, 0, 0, 40 * GST_MSECOND);
  moving.pan_speed = 10;
  moving.moving = TRUE;
  send(ptz.h.get(), moving);
  send(ptz.h.get(), pose(0.4, 0, 40 * GST_MSECOND, 80 * GST_MSECOND));
  GstBuffer* out = ptz.through(1);
  fail_unless(cerberus_buffer_peek_pose(out)->moving);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(no_frame_waits_in_a_live_pipeline_or_without_lockstep) {
  for (const bool live : {true, false}) {
    Ptz ptz(live ? kLine : kLine + "lockstep=off", live);
    for (int number = 0; number < 3; ++number) ptz.frame_shows(number, 80, 60);
  }
}
GST_END_TEST

GST_START_TEST(a_head_that_never_publishes_is_an_error_that_names_it) {
  for (const char* timeout : {"1000000", "1"}) {
    Ptz ptz(kLine + "head=missing lockstep-timeout=" + timeout, false);
    Bus bus(ptz.h.get());
    ptz.frame_shows(0, 80, 60);
    send(ptz.h.get(), pose(0));
    fail_unless_equals_int(gst_harness_push(ptz.h.get(), noise(ptz.in, 1)), GST_FLOW_ERROR);
    std::string text;
    fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR, &text), 1);
    fail_unless(
        text.find("\"missing\"") != std::string::npos && text.find("lockstep=off") != std::string::npos, "%s",
        text.c_str());
  }
}
GST_END_TEST

GST_START_TEST(a_flush_and_a_stop_end_the_waiting_at_once) {
  for (const bool flush : {true, false})
    assert_prompt(flush ? "flush" : "stop", [flush] {
      Ptz ptz(kLine, false);
      ptz.frame_shows(0, 80, 60);
      Push push(ptz, 1);
      return time_taken([&] {
        if (flush)
          gst_harness_push_event(ptz.h.get(), gst_event_new_flush_start());
        else
          gst_element_set_state(ptz.h->element, GST_STATE_NULL);
        fail_unless_equals_int(push.result(), GST_FLOW_FLUSHING);
      });
    });
}
GST_END_TEST

GST_START_TEST(after_a_flush_the_window_is_where_it_was) {
  Ptz ptz(kLine, false);
  ptz.frame_shows(0, 80, 60);
  send(ptz.h.get(), pose(kForty));
  ptz.frame_shows(1, 120, 60);
  push_flush(ptz.h.get());
  ptz.frame_shows(0, 120, 60);
}
GST_END_TEST

static Suite* virtualptz_lockstep_suite() {
  watch_library_log();
  Suite* s = suite_create("virtualptz in lock-step");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, not_live_a_frame_waits_for_its_pose);
  tcase_add_test(tc, missing_frames_are_announced_downstream);
  tcase_add_test(tc, a_frame_that_is_lost_behind_it_becomes_a_gap);
  tcase_add_test(tc, a_stream_without_a_rate_is_full_of_gaps);
  tcase_add_test(tc, a_segment_may_begin_with_a_gap);
  tcase_add_test(tc, of_two_poses_that_meet_the_earlier_counts_in_lockstep);
  tcase_add_test(tc, no_frame_waits_in_a_live_pipeline_or_without_lockstep);
  tcase_add_test(tc, a_head_that_never_publishes_is_an_error_that_names_it);
  tcase_add_test(tc, a_flush_and_a_stop_end_the_waiting_at_once);
  tcase_add_test(tc, after_a_flush_the_window_is_where_it_was);
  return s;
}

GST_CHECK_MAIN(virtualptz_lockstep)
