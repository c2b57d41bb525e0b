// SPDX-License-Identifier: LGPL-2.1-or-later
// What motionoverlay costs at 1920x1080 with nine boxes, each with a label, a trail of two seconds and one with the
// target's corners: milliseconds of CPU time a frame, as medians of rounds in which every row runs once. The peer is
// what an application would draw with cairo and GStreamer alone: nine plain rectangles with a text each, one surface
// an object, blended by GStreamer. Quote the ratios.
#include <cairo.h>
#include <cerberus/cerberus.h>
#include <gst/video/video-overlay-composition.h>
#include <gst/video/video.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "asked.h"
#include "frames.h"
#include "launch.h"

using namespace cerberus::bench;

namespace {

constexpr int kWidth = 1920, kHeight = 1080, kObjects = 9, kFrames = 150, kWarm = 60, kRounds = 7;
constexpr double kRate = 25;  // frames a second

// Nine people who walk, slowly grow and shrink as measured outlines do, and change their speed in every frame.
CerberusRegion walker(int id, int frame) {
  const double t = frame / kRate;
  CerberusRegion r;
  cerberus_region_init(&r);
  r.id = static_cast<guint>(id);
  r.tracked = TRUE;
  r.state = id % 4 == 3   ? CERBERUS_REGION_COASTED
            : id % 4 == 0 ? CERBERUS_REGION_STOPPED
                          : CERBERUS_REGION_SEEN;
  r.vx = 60 + 5 * id + 20 * std::sin(3 * t + id);
  r.vy = 12 * std::cos(2 * t + id);
  r.width = 60 + 7 * id + 2.5 * std::sin(7 * t);
  r.height = 2.6 * r.width;
  r.x = 40 + 190 * (id - 1) + 60 * std::sin(0.8 * t + id) + 0.7 * std::sin(31 * t);
  r.y = 120 + 70 * (id % 5) + 25 * std::cos(0.7 * t + id);
  r.confidence = 0.9;
  return r;
}

void annotate(GstBuffer* buffer, int frame) {
  for (int id = 1; id <= kObjects; ++id) {
    const CerberusRegion r = walker(id, frame);
    cerberus_buffer_add_region(buffer, &r);
  }
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.action = CERBERUS_FUSION_TRACK;
  fusion.target = 1;
  fusion.n_sensors = 3;
  fusion.rule = 1;
  fusion.sensors[1] = 1;
  cerberus_buffer_set_fusion(buffer, &fusion);
}

GstFlowReturn drop(GstPad*, GstObject*, GstBuffer* buffer) {
  gst_buffer_unref(buffer);
  return GST_FLOW_OK;
}

gboolean takes_compositions(GstPad* pad, GstObject* parent, GstQuery* query) {
  if (GST_QUERY_TYPE(query) != GST_QUERY_ALLOCATION) return gst_pad_query_default(pad, parent, query);
  gst_query_add_allocation_meta(query, GST_VIDEO_OVERLAY_COMPOSITION_META_API_TYPE, nullptr);
  return TRUE;
}

// Milliseconds a frame of the element; negative where it does not run. `attach`: downstream draws compositions.
double run_element(const char* line, const char* format, bool attach) {
  GstElement* element = launch(line);
  if (!element) return -1;
  GstPad* from = gst_pad_new("from", GST_PAD_SRC);
  GstPad* to = gst_pad_new("to", GST_PAD_SINK);
  gst_pad_set_chain_function(to, drop);
  if (attach) gst_pad_set_query_function(to, takes_compositions);
  GstPad* sink = gst_element_get_static_pad(element, "sink");
  GstPad* src = gst_element_get_static_pad(element, "src");
  gst_pad_link(from, sink);
  gst_pad_link(src, to);
  gst_pad_set_active(to, TRUE);
  gst_element_set_state(element, GST_STATE_PLAYING);
  gst_pad_set_active(from, TRUE);

  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format), kWidth, kHeight);
  info.fps_n = static_cast<int>(kRate);
  GstCaps* caps = gst_video_info_to_caps(&info);
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_pad_push_event(from, gst_event_new_stream_start("bench"));
  gst_pad_push_event(from, gst_event_new_caps(caps));
  gst_pad_push_event(from, gst_event_new_segment(&segment));
  GstBufferPool* pool = gst_video_buffer_pool_new();
  GstStructure* config = gst_buffer_pool_get_config(pool);
  gst_buffer_pool_config_set_params(config, caps, static_cast<guint>(info.size), 2, 2);
  gst_buffer_pool_set_config(pool, config);
  gst_buffer_pool_set_active(pool, TRUE);
  bool sane = true;
  double spent = 0;
  for (int frame = 0; frame < kWarm + kFrames && sane; ++frame) {
    GstBuffer* buffer = nullptr;
    gst_buffer_pool_acquire_buffer(pool, &buffer, nullptr);
    GST_BUFFER_PTS(buffer) = static_cast<GstClockTime>(frame * double{GST_SECOND} / kRate);
    GST_BUFFER_FLAG_UNSET(buffer, GST_BUFFER_FLAG_DISCONT);
    annotate(buffer, frame);
    const double begin = thread_seconds();
    sane = gst_pad_push(from, buffer) == GST_FLOW_OK;
    if (frame >= kWarm) spent += thread_seconds() - begin;
  }
  gst_element_set_state(element, GST_STATE_NULL);
  gst_pad_set_active(from, FALSE);
  gst_pad_set_active(to, FALSE);
  gst_buffer_pool_set_active(pool, FALSE);
  gst_object_unref(pool);
  gst_caps_unref(caps);
  for (GstPad* pad : {sink, src, from, to}) gst_object_unref(pad);
  gst_object_unref(element);
  return sane ? 1000 * spent / kFrames : -1;
}

// The peer's picture of one object.
GstVideoOverlayRectangle* plain_rectangle(const CerberusRegion& r) {
  const int width = static_cast<int>(r.width) + 8, height = static_cast<int>(r.height) + 8;
  GstBuffer* pixels = gst_buffer_new_allocate(nullptr, static_cast<gsize>(4) * width * height, nullptr);
  gst_buffer_add_video_meta(pixels, GST_VIDEO_FRAME_FLAG_NONE, GST_VIDEO_OVERLAY_COMPOSITION_FORMAT_RGB,
                            static_cast<guint>(width), static_cast<guint>(height));
  GstMapInfo map;
  gst_buffer_map(pixels, &map, GST_MAP_WRITE);
  std::memset(map.data, 0, map.size);
  cairo_surface_t* surface =
      cairo_image_surface_create_for_data(map.data, CAIRO_FORMAT_ARGB32, width, height, 4 * width);
  cairo_t* cr = cairo_create(surface);
  cairo_set_source_rgb(cr, 1, 0.6, 0);
  cairo_set_line_width(cr, 3);
  cairo_rectangle(cr, 4, 4, r.width, r.height);
  cairo_stroke(cr);
  cairo_set_font_size(cr, 23);
  cairo_move_to(cr, 8, 30);
  cairo_show_text(cr, (std::to_string(r.id) + " " + std::to_string(static_cast<int>(r.vx))).c_str());
  cairo_destroy(cr);
  cairo_surface_destroy(surface);
  gst_buffer_unmap(pixels, &map);
  GstVideoOverlayRectangle* rectangle = gst_video_overlay_rectangle_new_raw(
      pixels, static_cast<int>(r.x), static_cast<int>(r.y), static_cast<guint>(width),
      static_cast<guint>(height), GST_VIDEO_OVERLAY_FORMAT_FLAG_PREMULTIPLIED_ALPHA);
  gst_buffer_unref(pixels);
  return rectangle;
}

double run_peer(const char* format) {
  constexpr int kFew = 40;
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format), kWidth, kHeight);
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  gst_buffer_memset(buffer, 0, 100, info.size);
  const double begin = thread_seconds();
  for (int frame = 0; frame < kFew; ++frame) {
    GstVideoOverlayComposition* composition = gst_video_overlay_composition_new(nullptr);
    for (int id = 1; id <= kObjects; ++id) {
      GstVideoOverlayRectangle* rectangle = plain_rectangle(walker(id, frame));
      gst_video_overlay_composition_add_rectangle(composition, rectangle);
      gst_video_overlay_rectangle_unref(rectangle);
    }
    GstVideoFrame mapped;
    gst_video_frame_map(&mapped, &info, buffer, GST_MAP_READWRITE);
    gst_video_overlay_composition_blend(composition, &mapped);
    gst_video_frame_unmap(&mapped);
    gst_video_overlay_composition_unref(composition);
  }
  const double spent = thread_seconds() - begin;
  gst_buffer_unref(buffer);
  return 1000 * spent / kFew;
}

struct Row {
  const char* name;
  std::function<double()> run;
  double most = 0;  // the largest ratio to the peer that is asked for; 0: not judged
  std::vector<double> milliseconds = {};
};

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  Row rows[] = {
      {"cairo and GStreamer, I420", [] { return run_peer("I420"); }},
      {"cairo and GStreamer, BGRx", [] { return run_peer("BGRx"); }},
      {"motionoverlay, I420", [] { return run_element("motionoverlay", "I420", false); }, 0.3},
      {"motionoverlay, BGRx", [] { return run_element("motionoverlay", "BGRx", false); }, 0.3},
      {"motionoverlay, attached", [] { return run_element("motionoverlay", "I420", true); }, 0.3},
      {"motionoverlay show-trails=false, I420",
       [] { return run_element("motionoverlay show-trails=false", "I420", false); }},
      {"motionoverlay show-ids=false, I420",
       [] { return run_element("motionoverlay show-ids=false", "I420", false); }},
      {"motionoverlay show-boxes=false, I420",
       [] { return run_element("motionoverlay show-boxes=false", "I420", false); }},
  };
  for (int round = 0; round < kRounds; ++round)
    for (Row& row : rows) row.milliseconds.push_back(row.run());
  Asked asked;
  const double peer = median(rows[0].milliseconds);
  std::printf("%dx%d, %d boxes, medians of %d rounds\n", kWidth, kHeight, kObjects, kRounds);
  for (const Row& row : rows) {
    const double ms = median(row.milliseconds);
    std::printf(
        "%-40s %7.3f ms a frame, %6.3f of the first row%s\n", row.name, ms, ms / peer,
        row.most > 0 ? asked.at_most(row.name, ms >= 0 ? ms / peer : INFINITY, row.most).c_str() : "");
  }
  return asked.verdict();
}
