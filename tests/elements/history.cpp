// SPDX-License-Identifier: LGPL-2.1-or-later
// What every stage makes of the end of a scene (the rule itself: unit-frame_history). After each kind of break nothing
// may be published before three frames of the new scene were seen, and nothing of the old scene ever again.
#include "scene.h"
#include "support.h"

#include <gst/check/gsttestclock.h>

namespace {

using scene::Line;
using scene::Regions;
using scene::World;

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
  // Without cameramotion an unmarked cut cannot be detected.
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

// A repeated picture is not analysed (here it is black), carries the last result, and the scene continues.
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

// 12 s. Where the clock has not come so far, the time of the frame is wrong by itself, and the scene goes on. A frame that
// repeats the last picture begins no scene, and nothing of that is there any more after 12 s.
GST_START_TEST(a_live_camera_that_was_silent_begins_a_scene_where_the_clock_confirms_its_time) {
  for (const int variant : {0, 1, 2, 3}) {
    const bool confirmed = variant & 1, repeats = variant & 2;
    Line line("motiondetect confirm-time=0 ! identity", "");
    gst_harness_use_testclock(line.harness);
    gst_harness_set_live(line.harness, TRUE);
    g_autoptr(GstTestClock) clock = gst_harness_get_testclock(line.harness);
    gst_harness_set_src_caps_str(line.harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
    const World world;
    const auto see = [&](int k, GstClockTime late) {
      GstBuffer* in = scene::grey_buffer(world, k);
      GST_BUFFER_PTS(in) += late;
      if (late && repeats) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
      if (late == 0 || confirmed) gst_test_clock_set_time(clock, GST_BUFFER_PTS(in));
      GstBuffer* out = line.through(in);
      const auto found = Regions(out).size();
      gst_buffer_unref(out);
      return found;
    };
    for (int k = 0; k < 30; ++k) see(k, 0);
    fail_unless((see(30, 12 * GST_SECOND) > 0) == !confirmed);
  }
}
GST_END_TEST

Suite* history_suite() {
  Suite* suite = suite_create("history");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, nothing_is_published_until_three_frames_of_a_new_scene_were_seen, 0,
                      BREAKS * static_cast<int>(G_N_ELEMENTS(kLines)));
  tcase_add_test(tests, a_live_camera_that_was_silent_begins_a_scene_where_the_clock_confirms_its_time);
  tcase_add_test(tests, gap_buffers_pass_and_end_no_scene);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(history);
