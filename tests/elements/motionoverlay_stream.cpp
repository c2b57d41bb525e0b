// SPDX-License-Identifier: LGPL-2.1-or-later
// What motionoverlay does with frames, caps and drawings of others.
#include "overlay_rig.h"

using namespace outputs;

namespace {

const char* const kFeature = "video/x-raw(memory:SystemMemory,meta:GstVideoOverlayComposition)";

// The drawing of another element: four by four white pixels at this place.
GstVideoOverlayComposition* draw_square(GstBuffer* in, int x, int y) {
  GstBuffer* pixels = gst_buffer_new_allocate(nullptr, 4 * 4 * 4, nullptr);
  gst_buffer_memset(pixels, 0, 255, 64);
  gst_buffer_add_video_meta(pixels, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB, 4,
                            4);
  GstVideoOverlayRectangle* r =
      gst_video_overlay_rectangle_new_raw(pixels, x, y, 4, 4, GST_VIDEO_OVERLAY_FORMAT_FLAG_NONE);
  GstVideoOverlayComposition* square = gst_video_overlay_composition_new(r);
  gst_buffer_add_video_overlay_composition_meta(in, square);
  gst_buffer_unref(pixels);
  gst_video_overlay_rectangle_unref(r);
  return square;
}

}  // namespace

GST_START_TEST(the_other_branch_of_a_tee_keeps_its_pixels) {
  Harness h = started();
  GstBuffer* in = with_region(info_of(kCaps), region(1, 100, 80, 60, 90));
  GstBuffer* other = gst_buffer_ref(in);     // what a tee does
  GstBuffer* sibling = gst_buffer_copy(in);  // shares the memory, has own metas
  GstBuffer* out = through(h.get(), in);
  for (const guint8 byte : bytes(other)) fail_unless_equals_int(byte, 100);
  for (const guint8 byte : bytes(sibling)) fail_unless_equals_int(byte, 100);
  fail_if(bytes(out) == bytes(other));
  gst_buffer_unref(out);
  gst_buffer_unref(other);
  gst_buffer_unref(sibling);
}
GST_END_TEST

GST_START_TEST(drawings_are_attached_where_downstream_draws_them) {
  Harness h = attaching();
  GstBuffer* in = with_region(info_of(kCaps), region(1, 100, 80, 60, 90));
  GstMemory* memory = gst_buffer_peek_memory(in, 0);
  GstBuffer* out = through(h.get(), in);
  fail_unless(gst_buffer_peek_memory(out, 0) == memory);
  for (const guint8 byte : bytes(out)) fail_unless_equals_int(byte, 100);
  fail_unless(rectangles(out).size() >= 2);  // box and label
  gst_buffer_unref(out);
}
GST_END_TEST

// A sink that accepts any caps (a file sink) must not lose the drawing.
GST_START_TEST(the_caps_feature_is_used_only_where_downstream_draws) {
  for (const bool draws : {false, true}) {
    Harness h = harness("motionoverlay");
    if (draws)
      gst_harness_add_propose_allocation_meta(h.get(), GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE, nullptr);
    gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
    GstBuffer* out = through(h.get(), with_region(info_of(kCaps), region(1, 100, 80, 60, 90)));
    GstCaps* caps = gst_pad_get_current_caps(h->sinkpad);
    fail_unless_equals_int(gst_caps_features_contains(gst_caps_get_features(caps, 0),
                                                      GST_CAPS_FEATURE_META_GST_VIDEO_OVERLAY_COMPOSITION),
                           draws);
    fail_unless_equals_int(rectangles(out).empty(), !draws);
    gst_caps_unref(caps);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(a_downstream_with_only_the_caps_feature_gets_it) {
  Harness h = harness("motionoverlay");
  gst_harness_set_sink_caps_str(h.get(), kFeature);
  gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
  fail_if(drawn(h.get(), with_region(info_of(kCaps), region(1, 100, 80, 60, 90))).empty());
}
GST_END_TEST

GST_START_TEST(a_drawing_that_was_there_stays) {
  Harness h = attaching();
  GstBuffer* in = with_region(info_of(kCaps), region(1, 100, 80, 60, 90));
  GstVideoOverlayComposition* before = draw_square(in, 3, 5);
  const auto all = drawn(h.get(), in);
  fail_unless(all.size() >= 3);
  fail_unless_equals_int(all.back().x, 3);  // on top
  fail_unless_equals_int(all.back().y, 5);
  fail_unless_equals_int(gst_video_overlay_composition_n_rectangles(before),
                         1);  // the other's is not changed
  gst_video_overlay_composition_unref(before);
}
GST_END_TEST

// An overlay of others in front of ours, and a downstream that does not draw: both are blended.
GST_START_TEST(a_drawing_that_was_there_is_blended_where_downstream_does_not_draw) {
  Harness h = started("motionoverlay show-ids=false");
  const GstVideoInfo info = info_of(kCaps);
  for (const bool ours : {false, true}) {
    GstBuffer* in = frame(info, ours);
    if (ours) add(in, region(1, 100, 80, 60, 90));
    gst_video_overlay_composition_unref(draw_square(in, 4, 6));
    GstBuffer* out = through(h.get(), in);
    fail_if(gst_buffer_get_video_overlay_composition_meta(out));
    GstVideoFrame f;
    fail_unless(gst_video_frame_map(&f, &info, out, GST_MAP_READ));
    fail_unless(level(&f, 5, 7) > 230);  // white
    fail_unless_equals_int(level(&f, 100, 130) != 100, ours);
    gst_video_frame_unmap(&f);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// What others attached is a picture of its own: a box over it would seem to belong to it.
GST_START_TEST(a_drawing_that_was_there_lies_on_top_and_labels_keep_clear_of_it) {
  const GstVideoInfo info = info_of(kCaps);
  const auto framed = [&](int x, int y) {
    GstBuffer* in = with_region(info, region(1, 100, 80, 60, 90));
    gst_video_overlay_composition_unref(draw_square(in, x, y));
    return in;
  };
  Harness blending = started();
  GstBuffer* out = through(blending.get(), framed(98, 130));
  GstVideoFrame f;
  fail_unless(gst_video_frame_map(&f, &info, out, GST_MAP_READ));
  for (int y = 130; y < 134; ++y)
    for (int x = 98; x < 102; ++x) fail_unless(level(&f, x, y) > 230, "(%d, %d)", x, y);
  fail_unless(level(&f, 100, 129) < 230);
  gst_video_frame_unmap(&f);
  gst_buffer_unref(out);

  Harness h = attaching("motionoverlay show-boxes=false show-trails=false");
  const auto free = drawn(h.get(), framed(300, 200)), hindered = drawn(h.get(), framed(102, 72));
  fail_unless(free.size() == 2 && hindered.size() == 2);
  fail_unless(free[0].y < 72 && free[0].y + static_cast<int>(free[0].height) > 76);
  fail_unless(hindered[0].y > 76, "the label lies under it");
}
GST_END_TEST

GST_START_TEST(a_new_frame_size_is_drawn_in) {
  Harness h = attaching("motionoverlay crosshair=true");
  drawn(h.get(), frame(info_of(kCaps)));
  const std::string small = caps_string("NV12", 64, 48);
  gst_harness_set_src_caps_str(h.get(), small.c_str());
  const auto all = drawn(h.get(), frame(info_of(small), 1));
  fail_unless_equals_int(all.size(), 1);
  fail_unless_equals_int(all[0].x + all[0].width / 2, 32);
  fail_unless_equals_int(all[0].y + all[0].height / 2, 24);
}
GST_END_TEST

GST_START_TEST(a_downstream_that_begins_to_draw_is_noticed) {
  Harness h = started();
  fail_unless(drawn(h.get(), with_region(info_of(kCaps), region(1, 100, 80, 60, 90))).empty());
  gst_harness_add_propose_allocation_meta(h.get(), GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE, nullptr);
  fail_unless(gst_harness_push_upstream_event(h.get(), gst_event_new_reconfigure()));
  fail_if(drawn(h.get(), with_region(info_of(kCaps), region(1, 100, 80, 60, 90), 1)).empty());
}
GST_END_TEST

// The same where downstream leaves no choice of caps, so that they stay what they are.
GST_START_TEST(a_downstream_that_begins_to_draw_is_noticed_though_the_caps_stay) {
  Harness h = harness("motionoverlay");
  gst_harness_set_sink_caps_str(h.get(), kCaps.c_str());
  gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
  fail_unless(drawn(h.get(), with_region(info_of(kCaps), region(1, 100, 80, 60, 90))).empty());
  gst_harness_add_propose_allocation_meta(h.get(), GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE, nullptr);
  fail_unless(gst_harness_push_upstream_event(h.get(), gst_event_new_reconfigure()));
  fail_if(drawn(h.get(), with_region(info_of(kCaps), region(1, 100, 80, 60, 90), 1)).empty());
}
GST_END_TEST

GST_START_TEST(a_buffer_without_a_picture_passes_with_one_warning) {
  Harness h = started();
  Bus bus(h.get());
  for (int k = 0; k < 3; ++k) {
    GstBuffer* empty = gst_buffer_new();
    GST_BUFFER_PTS(empty) = k * GST_SECOND;
    add(empty, region(1, 100, 80, 60, 90));
    gst_buffer_unref(through(h.get(), empty));
  }
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
  fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR), 0);
}
GST_END_TEST

GST_START_TEST(two_instances_and_eos) {
  Harness a = attaching("motionoverlay show-boxes=false show-ids=false"), b = attaching("motionoverlay");
  drawn(a.get(), with_region(info_of(kCaps), region(1, 50, 50, 20, 40)));
  drawn(b.get(), with_region(info_of(kCaps), region(1, 90, 50, 20, 40)));
  fail_if(drawn(a.get(), with_region(info_of(kCaps), region(1, 90, 50, 20, 40), 1)).empty());
  fail_unless(gst_harness_push_event(a.get(), gst_event_new_eos()));
  fail_unless(event_came(a.get(), GST_EVENT_EOS));
}
GST_END_TEST

static Suite* motionoverlay_stream_suite() {
  watch_library_log();
  Suite* s = suite_create("motionoverlay_stream");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_other_branch_of_a_tee_keeps_its_pixels);
  tcase_add_test(tc, drawings_are_attached_where_downstream_draws_them);
  tcase_add_test(tc, the_caps_feature_is_used_only_where_downstream_draws);
  tcase_add_test(tc, a_downstream_with_only_the_caps_feature_gets_it);
  tcase_add_test(tc, a_drawing_that_was_there_stays);
  tcase_add_test(tc, a_drawing_that_was_there_is_blended_where_downstream_does_not_draw);
  tcase_add_test(tc, a_drawing_that_was_there_lies_on_top_and_labels_keep_clear_of_it);
  tcase_add_test(tc, a_new_frame_size_is_drawn_in);
  tcase_add_test(tc, a_downstream_that_begins_to_draw_is_noticed);
  tcase_add_test(tc, a_downstream_that_begins_to_draw_is_noticed_though_the_caps_stay);
  tcase_add_test(tc, a_buffer_without_a_picture_passes_with_one_warning);
  tcase_add_test(tc, two_instances_and_eos);
  return s;
}

GST_CHECK_MAIN(motionoverlay_stream)
