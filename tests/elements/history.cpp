// SPDX-License-Identifier: LGPL-2.1-or-later
// When a scene ends: the rule alone, and what every stage makes of it. After each kind of break nothing may be
// published before three frames of the new scene were seen, and nothing of the old scene ever again.
#include "../../plugins/detect/history.hpp"

#include "scene.h"
#include "support.h"

namespace {

using cerberus::plugin::History;
using scene::Line;
using scene::Regions;
using scene::World;

constexpr double kNominal = 0.04;

GST_START_TEST(frames_in_order_follow_each_other) {
  History history;
  fail_unless(history.next(0, kNominal).fresh);
  for (int k = 1; k < 10; ++k) {
    const History::Step step = history.next(k * scene::kStep, kNominal);
    fail_if(step.fresh);
    fail_unless(std::abs(step.seconds - 0.04) < 1e-9);
    fail_unless_equals_uint64(step.previous, (k - 1) * scene::kStep);
  }
}
GST_END_TEST

GST_START_TEST(a_dropped_history_and_time_far_back_begin_a_scene) {
  History history;
  history.next(GST_SECOND, kNominal);
  history.drop();
  History::Step step = history.next(GST_SECOND + scene::kStep, kNominal);
  fail_unless(step.fresh);
  fail_if(step.broken);
  step = history.next(GST_SECOND / 2, kNominal);
  fail_unless(step.fresh && step.broken && step.backwards);
  fail_if(history.next(GST_SECOND / 2, kNominal).fresh);  // the same time again: a duplicate, no step back
}
GST_END_TEST

// What goes wrong with timestamps while the frames themselves come as they should: frame k's, in frames.
struct Stamps {
  int (*of)(int k);
  bool told;
};
const Stamps kStamps[] = {
    {[](int k) { return k - (k % 10 == 9 ? 2 : 0); }, true},
    {[](int k) { return k - (k % 5 == 4 ? 2 : 0); }, true},
    // as a decoder met them: 0 3 1 2 6 4 5
    {[](int k) { return k + (k % 3 == 1 ? 2
                             : k > 0    ? -1
                                        : 0); }, true},
    {[](int k) { return 1000 - k; }, true},
    {[](int k) { return k - k / 20 * 4; }, true},  // a clock that is set back
    {[](int) { return 7; }, false},
};

GST_START_TEST(small_steps_back_are_a_matter_of_the_timestamps_only) {
  History history;
  double sum = 0;
  bool told = false;
  constexpr int kFrames = 200;
  for (int k = 0; k < kFrames; ++k) {
    const GstClockTime time = (10 + kStamps[__i__].of(k)) * scene::kStep;
    const History::Step step = history.next(time, __i__ == 1 ? 0 : kNominal);
    fail_unless(step.fresh == (k == 0), "frame %d", k);
    fail_unless(k == 0 || step.seconds > 0, "frame %d", k);
    sum += step.seconds;
    told = told || step.backwards;
  }
  fail_unless_equals_int(told, kStamps[__i__].told);
  fail_unless(std::abs(sum - 0.04 * (kFrames - 1)) < 0.1 * sum, "%f s", sum);
}
GST_END_TEST

// A clock that is set back once: guessed for a while, and then the new times count as the old ones did.
GST_START_TEST(times_are_believed_again_soon_after_a_step_back) {
  History history;
  GstClockTime time = GST_SECOND;
  for (int k = 0; k < 20; ++k) history.next(time += scene::kStep, kNominal);
  time -= 5 * scene::kStep;
  for (int k = 0; k < 12; ++k) {
    const History::Step step = history.next(time += 2 * scene::kStep / (k < 10 ? 8 : 1), kNominal);
    fail_if(step.fresh);
    if (k >= 10) fail_unless(std::abs(step.seconds - 2 * kNominal) < 1e-9, "frame %d: %f s", k, step.seconds);
  }
}
GST_END_TEST

GST_START_TEST(times_that_no_camera_can_have_are_not_known) {
  History history;
  history.next(0, kNominal);
  for (int k = 1; k < 100; ++k) {
    const History::Step step = history.next(k, kNominal);
    fail_if(step.fresh);
    fail_unless(step.seconds == kNominal, "frame %d: %f s", k, step.seconds);
  }
}
GST_END_TEST

GST_START_TEST(lost_pictures_are_passed_over_unless_they_are_many) {
  for (const bool timed : {true, false})
    for (const int lost : {1, 5, 6}) {
      History history;
      int k = 0;
      for (; k < 10; ++k) history.next(timed ? k * scene::kStep : GST_CLOCK_TIME_NONE, kNominal);
      for (int i = 0; i < lost; ++i) history.lose();
      k += lost;
      const History::Step step = history.next(timed ? k * scene::kStep : GST_CLOCK_TIME_NONE, kNominal);
      fail_unless(step.fresh == (lost > 5));
      if (lost <= 5) fail_unless(std::abs(step.seconds - (1 + lost) * kNominal) < 1e-9, "%f s", step.seconds);
      fail_if(timed && lost <= 5 && step.previous != 9 * scene::kStep);
      const History::Step next = history.next(timed ? (k + 1) * scene::kStep : GST_CLOCK_TIME_NONE, kNominal);
      fail_unless(std::abs(next.seconds - kNominal) < 1e-9, "%f s", next.seconds);
    }
}
GST_END_TEST

GST_START_TEST(a_gap_is_judged_by_the_rhythm_of_the_stream) {
  History fast, slow, unknown;
  fast.next(0, kNominal);
  fail_if(fast.next(240 * GST_MSECOND, kNominal).fresh);      // a stall
  fail_unless(fast.next(640 * GST_MSECOND, kNominal).fresh);  // 10 frames
  slow.next(0, 2.0);
  fail_if(slow.next(2 * GST_SECOND, 2.0).fresh);  // a frame every two seconds is no gap
  fail_unless(slow.next(9 * GST_SECOND, 2.0).fresh);
  unknown.next(0, 0);
  fail_if(unknown.next(2 * GST_SECOND, 0).fresh);  // variable rate: the first distance is the rhythm
  fail_if(unknown.next(4 * GST_SECOND, 0).fresh);
  fail_unless(unknown.next(11 * GST_SECOND, 0).fresh);
}
GST_END_TEST

GST_START_TEST(a_stream_slower_than_its_caps_is_not_blind) {
  History history;
  history.next(0, kNominal);
  fail_unless(history.next(GST_SECOND, kNominal).fresh);
  for (int k = 2; k < 10; ++k) fail_if(history.next(k * GST_SECOND, kNominal).fresh);
  // and a single gap does not excuse the next one
  History other;
  GstClockTime time = 0;
  other.next(time, kNominal);
  fail_unless(other.next(time += 5 * GST_SECOND, kNominal).fresh);
  fail_if(other.next(time += scene::kStep, kNominal).fresh);
  fail_unless(other.next(time += 5 * GST_SECOND, kNominal).fresh);
}
GST_END_TEST

GST_START_TEST(missing_timestamps_are_taken_as_evenly_spaced) {
  History history;
  fail_unless(history.next(GST_CLOCK_TIME_NONE, kNominal).fresh);
  const History::Step step = history.next(GST_CLOCK_TIME_NONE, kNominal);
  fail_if(step.fresh);
  fail_unless(step.seconds == kNominal);
  fail_if(history.next(GST_SECOND, kNominal).fresh);
  fail_if(history.next(GST_CLOCK_TIME_NONE, kNominal).fresh);
  fail_unless(
      history.next(GST_SECOND / 2, kNominal).fresh);  // backwards, seen across the frame without a time
}
GST_END_TEST

GST_START_TEST(missing_frames_are_told_from_a_mark_alone) {
  History history;
  fail_if(history.misses_frames(0, kNominal));  // nothing came before
  history.next(scene::kStep, kNominal);
  fail_if(history.misses_frames(2 * scene::kStep, kNominal));
  fail_unless(history.misses_frames(3 * scene::kStep, kNominal));
  fail_if(history.misses_frames(0, kNominal));  // backwards
  fail_if(history.misses_frames(GST_CLOCK_TIME_NONE, kNominal));
  fail_if(history.misses_frames(3 * scene::kStep, 0));  // no rhythm is known
  history.next(2 * scene::kStep, 0);
  fail_if(history.misses_frames(3 * scene::kStep, 0));
  fail_unless(history.misses_frames(4 * scene::kStep, 0));
}
GST_END_TEST

// ---- what the stages make of it

enum Break { DISCONT, FLUSH, SEGMENT, BACKWARDS, GAP, CAPS, CUT, EMPTY_BUFFERS, RESTART, BREAKS };
const char* const kBreakNames[] = {"discont", "flush", "segment",       "backwards", "gap",
                                   "caps",    "cut",   "empty buffers", "restart"};

const char* const kLines[] = {
    "motiondetect confirm-time=0 keep-planes=always",
    "cameramotion ! threeframediff ! fuzzythreshold ! motionregions keep-planes=always",
    "motionregions keep-planes=always",
    "motiontrack confirm-time=0",
};

// Shows another place after the break, in which a figure walks the other way.
GST_START_TEST(nothing_is_published_until_three_frames_of_a_new_scene_were_seen) {
  const int kind = __i__ % BREAKS;
  const char* launch = kLines[__i__ / BREAKS];
  // Without cameramotion nobody knows of an unmarked cut.
  if (kind == CUT && std::string(launch).find("motionregions") == 0) return;
  if (kind == CUT && std::string(launch).find("motiontrack") == 0) return;

  Line line(std::string(launch) + " ! identity");
  World before, after;
  after.wall = 5;
  after.start = 250;
  after.speed = -3;
  guint found = 0;
  line.run(before, 0, 30, [&](int, GstBuffer* out) { found += Regions(out).size(); });
  fail_unless(found > 0, "%s finds nothing before the break", launch);

  GstClockTime start = 30 * scene::kStep;
  switch (kind) {
    case FLUSH:
      gst_harness_push_event(line.harness, gst_event_new_flush_start());
      gst_harness_push_event(line.harness, gst_event_new_flush_stop(TRUE));
      [[fallthrough]];
    case SEGMENT: {
      push_segment(line.harness);
      break;
    }
    case BACKWARDS:
      start = 10 * scene::kStep;
      break;
    case GAP:
      start += 5 * GST_SECOND;
      break;
    case CAPS:  // alone: the harness would add a segment
      line.push_caps(scene::caps("GRAY8", scene::kWidth, scene::kHeight, ",framerate=50/1"));
      break;
    case EMPTY_BUFFERS:  // at once: not their times, but their number counts
      for (int k = 0; k < 6; ++k) {
        GstBuffer* empty = gst_buffer_new();
        GST_BUFFER_PTS(empty) = start;
        GstBuffer* out = line.through(empty);
        fail_unless_equals_int(Regions(out).size(), 0);
        gst_buffer_unref(out);
      }
      start += scene::kStep;
      break;
    case RESTART:
      line.restart();
      break;
    default:
      break;
  }

  bool again = false;
  for (int k = 0; k < 30; ++k) {
    GstBuffer* in = scene::grey_buffer(after, k);
    GST_BUFFER_PTS(in) = start + k * scene::kStep;
    if (kind == DISCONT && k == 0) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT);
    GstBuffer* out = line.through(in);
    const Regions regions(out);
    if (k < 2) {
      fail_unless_equals_int(regions.size(), 0);
      const auto* threshold = records::threshold_facts_of(out);
      fail_unless(threshold && !threshold->result.ready, "%s: frame %d after %s is ready", launch, k,
                  kBreakNames[kind]);
    }
    for (guint i = 0; i < regions.size(); ++i)
      fail_unless(
          scene::overlaps_figure(regions[i], after, k) || scene::overlaps_figure(regions[i], after, k - 1),
          "%s: a wrong region %u frames after %s: %s", launch, k, kBreakNames[kind], regions.text().c_str());
    again = again || regions.size() > 0;
    gst_buffer_unref(out);
  }
  fail_unless(again, "%s finds nothing after %s", launch, kBreakNames[kind]);
}
GST_END_TEST

// A repeated picture is not looked at (here it is black), carries the last result, and the scene goes on.
GST_START_TEST(gap_buffers_pass_and_end_no_scene) {
  Line line("motiondetect confirm-time=0 ! identity");
  const World world;
  line.run(world, 0, 20);
  GstBuffer* gap = gst_buffer_new_allocate(nullptr, scene::kWidth * scene::kHeight, nullptr);
  gst_buffer_memset(gap, 0, 0, scene::kWidth * scene::kHeight);
  GST_BUFFER_PTS(gap) = 20 * scene::kStep;
  GST_BUFFER_FLAG_SET(gap, GST_BUFFER_FLAG_GAP);
  GstBuffer* out = line.through(gap);
  fail_unless(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_GAP));
  fail_unless(Regions(out).size() > 0);
  gst_buffer_unref(out);
  line.run(world, 21, 22, [](int, GstBuffer* buffer) { fail_unless(Regions(buffer).size() > 0); });
}
GST_END_TEST

Suite* history_suite() {
  Suite* suite = suite_create("history");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, frames_in_order_follow_each_other);
  tcase_add_test(tests, a_dropped_history_and_time_far_back_begin_a_scene);
  tcase_add_loop_test(tests, small_steps_back_are_a_matter_of_the_timestamps_only, 0, G_N_ELEMENTS(kStamps));
  tcase_add_test(tests, times_are_believed_again_soon_after_a_step_back);
  tcase_add_test(tests, times_that_no_camera_can_have_are_not_known);
  tcase_add_test(tests, lost_pictures_are_passed_over_unless_they_are_many);
  tcase_add_test(tests, a_gap_is_judged_by_the_rhythm_of_the_stream);
  tcase_add_test(tests, a_stream_slower_than_its_caps_is_not_blind);
  tcase_add_test(tests, missing_timestamps_are_taken_as_evenly_spaced);
  tcase_add_loop_test(tests, nothing_is_published_until_three_frames_of_a_new_scene_were_seen, 0,
                      BREAKS * static_cast<int>(G_N_ELEMENTS(kLines)));
  tcase_add_test(tests, missing_frames_are_told_from_a_mark_alone);
  tcase_add_test(tests, gap_buffers_pass_and_end_no_scene);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(history);
