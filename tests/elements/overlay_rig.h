// SPDX-License-Identifier: LGPL-2.1-or-later
// What the tests of motionoverlay share: a harness that sees what was drawn, as pixels or as rectangles.
#pragma once

#include <algorithm>

#include "outputs.h"

#include <gst/video/video-overlay-composition.h>

namespace outputs {

constexpr int kWidth = 320, kHeight = 240;
inline const std::string kCaps = caps_string("I420", kWidth, kHeight);

struct Rectangle {
  int x, y;
  unsigned width, height;
};

inline std::vector<Rectangle> rectangles(GstBuffer* buffer) {
  std::vector<Rectangle> all;
  const auto* meta = gst_buffer_get_video_overlay_composition_meta(buffer);
  if (!meta) return all;
  for (guint i = 0; i < gst_video_overlay_composition_n_rectangles(meta->overlay); ++i) {
    Rectangle r;
    gst_video_overlay_rectangle_get_render_rectangle(
        gst_video_overlay_composition_get_rectangle(meta->overlay, i), &r.x, &r.y, &r.width, &r.height);
    all.push_back(r);
  }
  return all;
}

inline Harness started(const char* line = "motionoverlay", const std::string& caps = kCaps) {
  Harness h = harness(line);
  gst_harness_set_src_caps_str(h.get(), caps.c_str());
  return h;
}

// A downstream that draws compositions itself.
inline Harness attaching(const char* line = "motionoverlay") {
  Harness h = harness(line);
  gst_harness_add_propose_allocation_meta(h.get(), GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE, nullptr);
  gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
  return h;
}

inline GstBuffer* through(GstHarness* h, GstBuffer* buffer) {
  fail_unless_equals_int(gst_harness_push(h, buffer), GST_FLOW_OK);
  return gst_harness_pull(h);
}

inline std::vector<Rectangle> drawn(GstHarness* h, GstBuffer* buffer) {
  GstBuffer* out = through(h, buffer);
  const auto all = rectangles(out);
  gst_buffer_unref(out);
  return all;
}

inline GstBuffer* with_region(const GstVideoInfo& info, const CerberusRegion& r, int number = 0) {
  GstBuffer* buffer = frame(info, number);
  add(buffer, r);
  return buffer;
}

// Luma (or green) of a pixel, whatever the format.
inline int level(GstVideoFrame* f, int x, int y) {
  const int comp = GST_VIDEO_FORMAT_INFO_IS_RGB(f->info.finfo) ? GST_VIDEO_COMP_G : GST_VIDEO_COMP_Y;
  return sample_at(f, static_cast<guint>(comp), x, y);
}

inline int changed_pixels(GstVideoFrame* f, int x0, int y0, int x1, int y1, int was) {
  int n = 0;
  for (int y = std::max(y0, 0); y < std::min(y1, GST_VIDEO_FRAME_HEIGHT(f)); ++y)
    for (int x = std::max(x0, 0); x < std::min(x1, GST_VIDEO_FRAME_WIDTH(f)); ++x) n += level(f, x, y) != was;
  return n;
}

}  // namespace outputs
