// SPDX-License-Identifier: LGPL-2.1-or-later
// From the edge of a PIR sensor to the first command of the motors nothing waits for a frame in a live pipeline,
// whatever its frame rate and the camera's delay are. Here by the clock of the test; loop_real_time.cpp measures the
// processing time.
//
// A rising edge is reported when it has lasted for min-pulse (debounce delays falls only), decided at once with the last
// frame, and executed at once. A reading from before the first frame waits for that frame.
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

// gst-check's macros bite standard headers: last.
#include "fusion_rig.h"
#include "head_rig.h"
#include "loop.h"

namespace {

GST_START_TEST(a_rise_is_published_when_it_has_lasted_for_min_pulse) {
  for (const auto& [pulse, properties] : {std::pair{10 * GST_MSECOND, ""},
                                          {GstClockTime{0}, "min-pulse=0 debounce=0"},
                                          {GST_MSECOND, "min-pulse=1000000 debounce=50000000"}})
    for (int ms = 1000; ms < 1034; ++ms) {
      const std::string script = "script=\"0,0,0,0; " + std::to_string(ms / 1000.0) + ",0,0,1\"";
      GstHarness* h = gst_harness_new_parse(("pirsrc driver=scripted " + script + " " + properties).c_str());
      gst_harness_play(h);
      for (bool risen = false; !risen;) {
        g_autoptr(GstBuffer) reading = gst_harness_pull(h);
        fail_unless(reading != nullptr);
        guint8 values[3];
        fail_unless_equals_uint64(gst_buffer_extract(reading, 0, values, 3), 3);
        risen = values[2] == 1;
        const GstClockTime edge = static_cast<GstClockTime>(ms) * GST_MSECOND;
        if (risen) fail_unless_equals_uint64(GST_BUFFER_PTS(reading), edge + pulse);
      }
      gst_harness_teardown(h);
    }
}
GST_END_TEST

// A motiondetect before a wall on which a camera turns.
class Detection {
 public:
  explicit Detection(GstClockTime step) : step_(step), harness_(gst_harness_new("motiondetect")) {
    gst_harness_set_live(harness_, TRUE);
    gst_harness_set_src_caps_str(harness_, kCaps);
  }
  ~Detection() { gst_harness_teardown(harness_); }
  Detection(const Detection&) = delete;

  // The frame of `time`, which must come out before the next one goes in.
  GstBuffer* frame(GstClockTime time) {
    GstBuffer* seen = scene::grey_buffer(world_, number_++);
    GST_BUFFER_PTS(seen) = time;
    GST_BUFFER_DURATION(seen) = step_;
    fail_unless_equals_int(gst_harness_push(harness_, seen), GST_FLOW_OK);
    GstBuffer* found = gst_harness_try_pull(harness_);
    fail_unless(found && GST_BUFFER_PTS(found) == time, "motiondetect kept a frame");
    turned_ += std::abs(cerberus_buffer_peek_camera_motion(found)->matrix[2] + world_.pan) < 0.5;
    return found;
  }
  int turned() const { return turned_; }  // frames in which it saw the camera's turn

  static constexpr char kCaps[] = "video/x-raw,format=GRAY8,framerate=30/1,width=320,height=240";

 private:
  const scene::World world_{.figure = false, .pan = 3};
  const GstClockTime step_;
  GstHarness* harness_;
  int number_ = 0, turned_ = 0;
};

// The direction of the last command to the head.
int command(const head_rig::Pipe& record) {
  std::string line;
  while (!line.starts_with("command")) line = record.line();
  return head_rig::way_of(line);
}

// What went past the frames, from fusion to the head; whether there was anything.
bool hand_on(rig::Rig& fusion, head_rig::Rig& head) {
  bool any = false;
  while (GstEvent* event = gst_harness_try_pull_event(fusion.video)) {
    const bool past = GST_EVENT_TYPE(event) == GST_EVENT_CUSTOM_DOWNSTREAM_OOB;
    any = any || past;
    if (past)
      gst_harness_push_event(head.harness, event);
    else
      gst_event_unref(event);
  }
  return any;
}

// Time from an edge to the first command, behind a camera with a frame each `step`, which are `age` old when they come.
GstClockTime reaction(GstClockTime edge, GstClockTime step, GstClockTime age, bool detects = false) {
  const std::string name = head_rig::new_head();
  Detection detection(step);
  rig::Rig fusion(true, "head=" + name);
  gst_harness_set_src_caps_str(fusion.video, Detection::kCaps);
  fusion.add_pir();
  fusion.read(0, {0, 0, 0});
  head_rig::Pipe record;
  head_rig::Rig head("watchdog-timeout=0 " + head_rig::scripted("record " + record.writer(), name),
                     head_rig::Source::live);
  const auto set_time = [&](GstClockTime now) {
    gst_harness_set_time(fusion.video, now);
    gst_harness_set_time(head.harness, now);
  };
  bool received = false;
  for (GstClockTime time = 0;; time += step) {
    const GstClockTime now = time + age;
    if (now >= edge && !received) {
      set_time(edge);
      fusion.read(edge, {0, 0, 1});
      received = true;
      if (hand_on(fusion, head) && command(record) == 1) return 0;
    }
    set_time(now);
    GstBuffer* frame = detects ? detection.frame(time) : rig::frame(time);
    const CerberusPose ahead = rig::pose(0, time, 0, name.c_str());
    cerberus_buffer_set_pose(frame, &ahead);
    fail_unless_equals_int(gst_harness_push(fusion.video, frame), GST_FLOW_OK);
    head.push(gst_harness_pull(fusion.video));
    const int way = command(record);
    if (way == 0) {
      fail_unless(now < edge + GST_SECOND, "it is not obeyed at all");
      continue;
    }
    fail_unless(received && way == 1);
    fail_unless(!detects || detection.turned() > 5);
    return now - edge;
  }
}

GST_START_TEST(no_edge_waits_for_a_frame) {
  GstClockTime worst = 0;
  for (const GstClockTime rate : {10, 15, 30}) {
    const GstClockTime step = GST_SECOND / rate, first = 700 * GST_MSECOND;
    for (const GstClockTime age : std::initializer_list<GstClockTime>{0, 20 * GST_MSECOND, step, 4 * step})
      for (GstClockTime edge = first; edge < first + step; edge += 7 * GST_MSECOND)
        worst = std::max(worst, reaction(edge, step, age));
    for (const GstClockTime age : std::initializer_list<GstClockTime>{0, 4 * step})
      for (GstClockTime edge = first; edge < first + step; edge += 23 * GST_MSECOND)
        worst = std::max(worst, reaction(edge, step, age, true));
  }
  g_print("at most %.1f ms, work not counted\n", static_cast<double>(worst) / GST_MSECOND);
  fail_unless_equals_uint64(worst, 0);
}
GST_END_TEST

// The next one that comes is a step later at most.
GST_START_TEST(what_was_said_before_the_first_frame_comes_with_it) {
  const GstClockTime step = GST_SECOND / 30;
  fail_unless_equals_uint64(reaction(20 * GST_MSECOND, step, 30 * GST_MSECOND), 10 * GST_MSECOND);
}
GST_END_TEST

Suite* loop_promise_suite() {
  Suite* suite = suite_create("loop_promise");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 90);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, a_rise_is_published_when_it_has_lasted_for_min_pulse);
  tcase_add_test(tests, no_edge_waits_for_a_frame);
  tcase_add_test(tests, what_was_said_before_the_first_frame_comes_with_it);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(loop_promise);
