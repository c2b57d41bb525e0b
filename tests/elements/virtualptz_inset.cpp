// SPDX-License-Identifier: LGPL-2.1-or-later
// The scene of 320 x 240 in the corner of a window of 160 x 120: 0.3 x 160 = 48 pixels wide, 36 high, 0.02 x 160 = 3
// from the upper right corner. A window that looks straight ahead lies at (80, 60), so its place in the inset is 12..36
// x 9..27. A pan of 8.2132 degrees moves it by 40 pixels (virtualptz.cpp), 6 of the inset.
#include <cmath>
#include <span>
#include <string>

#include "outputs.h"

#include <gst/video/video-overlay-composition.h>

using namespace outputs;

namespace {

const std::string kLine = "virtualptz width=160 height=120 ";
constexpr double kForty = 8.2132107;  // degrees

struct Window {
  Harness h;
  GstVideoInfo in;
  explicit Window(const std::string& line, const char* format = "I420", int width = 320, int height = 240)
      : h(harness(line.c_str())), in(info_of(caps_string(format, width, height))) {
    gst_harness_set_live(h.get(), TRUE);
    gst_harness_set_src_caps_str(h.get(), caps_string(format, width, height).c_str());
  }
  GstBuffer* through(GstBuffer* buffer) {
    fail_unless_equals_int(gst_harness_push(h.get(), buffer), GST_FLOW_OK);
    return gst_harness_pull(h.get());
  }
};

// The only rectangle on a buffer; borrowed.
GstVideoOverlayRectangle* rectangle(GstBuffer* buffer) {
  auto* meta = gst_buffer_get_video_overlay_composition_meta(buffer);
  fail_unless(meta && gst_video_overlay_composition_n_rectangles(meta->overlay) == 1);
  return gst_video_overlay_composition_get_rectangle(meta->overlay, 0);
}

// Looks at a few pixels: the scene is of one colour. BGRA in memory.
void is_marked(GstVideoOverlayRectangle* drawing, int left, int top, int right, int bottom) {
  GstBuffer* pixels =
      gst_video_overlay_rectangle_get_pixels_unscaled_argb(drawing, GST_VIDEO_OVERLAY_FORMAT_FLAG_NONE);
  GstMapInfo map;
  fail_unless(gst_buffer_map(pixels, &map, GST_MAP_READ));
  const auto at = [&](int x, int y) { return map.data + 4 * (48 * y + x); };
  const guint8* inside = at((left + right) / 2, (top + bottom) / 2);
  fail_unless_equals_int(inside[3], 255);
  for (int y = 0; y < 36; ++y)
    for (int x = 0; x < 48; ++x) {
      const bool in = x >= left && x < right && y >= top && y < bottom;
      const bool line = !in && x >= left - 1 && x <= right && y >= top - 1 && y <= bottom;
      for (int c = 0; c < 3; ++c) {
        const double expected = in ? inside[c] : line ? 255 : 0.65 * inside[c];
        fail_unless(std::abs(at(x, y)[c] - expected) <= 1, "(%d, %d) is %d, not %.0f", x, y, at(x, y)[c],
                    expected);
      }
      fail_unless_equals_int(at(x, y)[3], 255);
    }
  gst_buffer_unmap(pixels, &map);
}

}  // namespace

GST_START_TEST(the_scene_is_in_the_corner_with_the_windows_place_in_it_in_every_format) {
  for (const char* format : std::span(kFormats).first(kByteFormatCount)) {
    Window window(kLine + "inset=true", format);
    GstBuffer* out = window.through(frame(window.in));
    GstVideoOverlayRectangle* drawing = rectangle(out);
    gint x = 0, y = 0;
    guint width = 0, height = 0;
    gst_video_overlay_rectangle_get_render_rectangle(drawing, &x, &y, &width, &height);
    fail_unless_equals_int(x, 109);
    fail_unless_equals_int(y, 3);
    fail_unless_equals_int(width, 48);
    fail_unless_equals_int(height, 36);
    is_marked(drawing, 12, 9, 36, 27);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(the_place_moves_with_the_head) {
  Window window(kLine + "inset=true");
  gst_buffer_unref(window.through(frame(window.in)));
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.pan = kForty;
  gst_harness_push_upstream_event(window.h.get(), cerberus_event_new_pose(&pose));
  GstBuffer* out = window.through(frame(window.in, 1));
  is_marked(rectangle(out), 18, 9, 42, 27);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(the_frames_own_pixels_stay_as_they_are) {
  Window with(kLine + "inset=true"), without(kLine);
  GstBuffer *a = with.through(frame(with.in)), *b = without.through(frame(without.in));
  fail_unless(bytes(a) == bytes(b));
  fail_if(gst_buffer_get_video_overlay_composition_meta(b));
  gst_buffer_unref(a);
  gst_buffer_unref(b);
}
GST_END_TEST

GST_START_TEST(motionoverlay_draws_it) {
  Window window(kLine + "inset=true ! motionoverlay", "GRAY8");
  GstBuffer* out = window.through(frame(window.in));
  const auto pixels = bytes(out);
  const auto at = [&](int x, int y) { return pixels[static_cast<std::size_t>(160 * y + x)]; };
  fail_unless_equals_int(at(108, 20), 100);
  fail_unless(at(109, 20) < 90, "%d beside the place", at(109, 20));
  fail_unless(at(109 + 11, 20) > 200, "%d on the line", at(109 + 11, 20));
  fail_unless(std::abs(at(109 + 24, 20) - 100) <= 1, "%d in the place", at(109 + 24, 20));
  fail_unless_equals_int(at(157, 20), 100);
  fail_unless_equals_int(at(120, 2), 100);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(a_window_without_room_for_it_has_none) {
  Window window("virtualptz width=40 height=30 inset=true");
  GstBuffer* out = window.through(frame(window.in));
  fail_if(gst_buffer_get_video_overlay_composition_meta(out));
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(it_follows_a_change_of_the_pictures_size) {
  Window window(kLine + "inset=true");
  gst_buffer_unref(window.through(frame(window.in)));
  const std::string other = caps_string("RGB", 480, 360);
  gst_harness_set_src_caps_str(window.h.get(), other.c_str());
  GstBuffer* out = window.through(frame(info_of(other), 1));
  is_marked(rectangle(out), 16, 12, 32, 24);  // a third of the picture, in its middle
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(what_lies_on_the_wide_picture_does_not_come_through) {
  Window window(kLine);
  GstBuffer* buffer = frame(window.in);
  GstVideoOverlayComposition* upstream = gst_video_overlay_composition_new(nullptr);
  gst_buffer_add_video_overlay_composition_meta(buffer, upstream);
  gst_video_overlay_composition_unref(upstream);
  GstBuffer* out = window.through(buffer);
  fail_if(gst_buffer_get_video_overlay_composition_meta(out));
  gst_buffer_unref(out);
}
GST_END_TEST

static Suite* virtualptz_inset_suite() {
  Suite* s = suite_create("virtualptz_inset");
  TCase* tc = tcase_create("inset");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_scene_is_in_the_corner_with_the_windows_place_in_it_in_every_format);
  tcase_add_test(tc, the_place_moves_with_the_head);
  tcase_add_test(tc, the_frames_own_pixels_stay_as_they_are);
  tcase_add_test(tc, motionoverlay_draws_it);
  tcase_add_test(tc, a_window_without_room_for_it_has_none);
  tcase_add_test(tc, it_follows_a_change_of_the_pictures_size);
  tcase_add_test(tc, what_lies_on_the_wide_picture_does_not_come_through);
  return s;
}

GST_CHECK_MAIN(virtualptz_inset)
