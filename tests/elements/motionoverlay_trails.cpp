// SPDX-License-Identifier: LGPL-2.1-or-later
// Trails behind moving tracks.
#include <functional>
#include <tuple>

#include "overlay_rig.h"

using namespace outputs;

namespace {

// From the frame before `buffer` to it. way: of the picture since a path began; 0 = there is no path.
void set_camera(GstBuffer* buffer, double dx, guint scene_age, double way = 0) {
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.matrix[2] = dx;
  const GstClockTime length = GST_SECOND / 25, now = GST_BUFFER_PTS(buffer);
  if (now >= length) motion.from = now - length;
  motion.scene_age = scene_age;
  motion.path_id = way != 0;
  motion.path[2] = way;
  cerberus_buffer_set_camera_motion(buffer, &motion);
}

// Width of everything drawn after 30 frames in which an object went `step` pixels a frame and the camera moved the
// picture by `pan`.
int trail_extent(double step, double pan, const char* line = "motionoverlay show-boxes=false show-ids=false",
                 const std::function<void(GstHarness*, GstBuffer*, int)>& disturb = {}) {
  Harness h = attaching(line);
  std::vector<Rectangle> all;
  for (int k = 0; k < 30; ++k) {
    GstBuffer* in = frame(info_of(kCaps), k);
    add(in, region(1, 150 + step * (k - 15), 100, 20, 40));
    set_camera(in, pan, k + 1);
    if (disturb) disturb(h.get(), in, k);
    all = drawn(h.get(), in);
  }
  int left = kWidth, right = 0;
  for (const Rectangle& r : all) left = std::min(left, r.x), right = std::max(right, r.x + int(r.width));
  return std::max(0, right - left);
}

}  // namespace

GST_START_TEST(a_trail_is_as_long_as_the_way) {
  const int extent = trail_extent(4, 0);  // 29 steps of 4 pixels
  fail_unless(extent >= 116 && extent <= 126, "%d", extent);
}
GST_END_TEST

GST_START_TEST(a_trail_lies_on_the_scene_while_the_camera_turns) {
  // The object stands in the scene: the whole way in the picture is the camera's.
  const int extent = trail_extent(-4, -4);
  fail_unless(extent <= 12, "%d", extent);
}
GST_END_TEST

// The same, and of three frames one is shown, marked as a leaky queue marks it.
GST_START_TEST(a_trail_lies_on_the_scene_across_dropped_frames) {
  Harness h = attaching("motionoverlay show-boxes=false show-ids=false");
  std::vector<Rectangle> all;
  for (int k = 0; k < 30; k += 3) {
    GstBuffer* in = frame(info_of(kCaps), k);
    add(in, region(1, 150 - 4 * (k - 15), 100, 20, 40));
    set_camera(in, -4, k + 1, 5 - 4 * k);
    GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT);
    all = drawn(h.get(), in);
  }
  fail_if(all.empty());  // not forgotten either
  int left = kWidth, right = 0;
  for (const Rectangle& r : all) left = std::min(left, r.x), right = std::max(right, r.x + int(r.width));
  fail_unless(right - left <= 12, "%d", right - left);
}
GST_END_TEST

// Camera motion of another element has no frame number and no path: the time from which it starts shows that a frame
// is missing.
GST_START_TEST(where_the_motion_across_a_dropped_frame_is_unknown_a_trail_begins_anew) {
  const auto extent = [](int dropped) {
    Harness h = attaching("motionoverlay show-boxes=false show-ids=false");
    std::vector<Rectangle> all;
    for (int k = 0; k < 30; ++k) {
      if (k == dropped) continue;
      GstBuffer* in = frame(info_of(kCaps), k);
      add(in, region(1, 150 + 4 * (k - 15), 100, 20, 40));
      set_camera(in, 0, 0);
      all = drawn(h.get(), in);
    }
    int left = kWidth, right = 0;
    for (const Rectangle& r : all) left = std::min(left, r.x), right = std::max(right, r.x + int(r.width));
    return right - left;
  };
  fail_unless(extent(-1) >= 116, "%d", extent(-1));
  fail_unless(extent(24) >= 16 && extent(24) <= 26, "%d", extent(24));  // four steps since then
}
GST_END_TEST

GST_START_TEST(a_trail_is_as_old_as_trail_time) {
  // 0.4 s at 25 frames a second: 10 steps.
  const int extent = trail_extent(4, 0, "motionoverlay show-boxes=false show-ids=false trail-time=400000000");
  fail_unless(extent >= 40 && extent <= 50, "%d", extent);
  fail_unless_equals_int(trail_extent(4, 0, "motionoverlay show-boxes=false show-ids=false trail-time=0"), 0);
  fail_unless_equals_int(
      trail_extent(4, 0, "motionoverlay show-boxes=false show-ids=false show-trails=false"), 0);
}
GST_END_TEST

GST_START_TEST(trails_are_forgotten_where_the_scene_begins_anew) {
  const char* line = "motionoverlay show-boxes=false show-ids=false";
  // Four steps remain behind frame 25.
  const auto forgets = [&](const std::function<void(GstHarness*, GstBuffer*)>& event) {
    const int extent = trail_extent(4, 0, line, [&](GstHarness* h, GstBuffer* in, int k) {
      if (k == 25) event(h, in);
    });
    fail_unless(extent >= 16 && extent <= 26, "%d", extent);
  };
  forgets([](GstHarness*, GstBuffer* in) { GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT); });
  forgets([](GstHarness*, GstBuffer* in) { set_camera(in, 0, 1); });  // a cut
  forgets([](GstHarness* h, GstBuffer*) { push_flush(h); });
}
GST_END_TEST

// Cut off at the frame's edge, the lower edge of a box is not where the object stands.
GST_START_TEST(a_trail_does_not_follow_the_edge_of_the_frame) {
  for (const auto& [x, y, dx, dy] : {std::tuple{50, 200, 10, 0}, {0, 50, 0, 10}, {300, 50, 0, 10}}) {
    Harness h = attaching("motionoverlay show-boxes=false show-ids=false");
    for (int k = 0; k < 5; ++k)
      fail_unless(
          drawn(h.get(), with_region(info_of(kCaps), region(1, x + k * dx, y + k * dy, 20, 40), k)).empty());
  }
}
GST_END_TEST

GST_START_TEST(time_that_runs_backwards_begins_a_trail_anew) {
  Harness h = attaching("motionoverlay show-boxes=false show-ids=false");
  drawn(h.get(), with_region(info_of(kCaps), region(1, 50, 50, 20, 40), 10));
  fail_if(drawn(h.get(), with_region(info_of(kCaps), region(1, 90, 50, 20, 40), 11)).empty());
  fail_unless(drawn(h.get(), with_region(info_of(kCaps), region(1, 130, 50, 20, 40), 2)).empty());
}
GST_END_TEST

GST_START_TEST(frames_without_time_stamps_have_trails_too) {
  Harness h = attaching("motionoverlay show-boxes=false show-ids=false");
  std::vector<Rectangle> all;
  for (int k = 0; k < 5; ++k) {
    GstBuffer* in = with_region(info_of(kCaps), region(1, 50 + 10 * k, 50, 20, 40));
    GST_BUFFER_PTS(in) = GST_CLOCK_TIME_NONE;
    all = drawn(h.get(), in);
  }
  fail_if(all.empty());
}
GST_END_TEST

static Suite* motionoverlay_trails_suite() {
  watch_library_log();
  Suite* s = suite_create("motionoverlay_trails");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_trail_is_as_long_as_the_way);
  tcase_add_test(tc, a_trail_lies_on_the_scene_while_the_camera_turns);
  tcase_add_test(tc, a_trail_lies_on_the_scene_across_dropped_frames);
  tcase_add_test(tc, where_the_motion_across_a_dropped_frame_is_unknown_a_trail_begins_anew);
  tcase_add_test(tc, a_trail_is_as_old_as_trail_time);
  tcase_add_test(tc, trails_are_forgotten_where_the_scene_begins_anew);
  tcase_add_test(tc, a_trail_does_not_follow_the_edge_of_the_frame);
  tcase_add_test(tc, time_that_runs_backwards_begins_a_trail_anew);
  tcase_add_test(tc, frames_without_time_stamps_have_trails_too);
  return s;
}

GST_CHECK_MAIN(motionoverlay_trails)
