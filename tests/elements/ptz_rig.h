// SPDX-License-Identifier: LGPL-2.1-or-later
// A virtualptz in a harness, and pictures for it.
//
// A picture of 320 x 240 that sees 60 degrees has F = 160 / tan 30 = 277.128; a window of 160 x 120 rests at (80, 60)
// and reaches atan(80 / F) = 16.102 degrees to each side and atan(60 / F) = 12.216 up and down. A pan of atan(40 / F) =
// 8.2132 degrees moves it by 40 pixels.
#pragma once

#include <string>

#include "outputs.h"

namespace ptz_rig {

using namespace outputs;

inline constexpr int kWidth = 320, kHeight = 240, kWindowWidth = 160, kWindowHeight = 120;
inline constexpr double kForty = 8.2132107;  // degrees
inline const std::string kLine = "virtualptz width=160 height=120 ";

struct Picture {
  GstVideoInfo info;
  GstBuffer* buffer;
  GstVideoFrame frame;
  Picture(const GstVideoInfo& i, GstBuffer* b) : info(i), buffer(b) {
    fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  }
  ~Picture() {
    gst_video_frame_unmap(&frame);
    gst_buffer_unref(buffer);
  }
  Picture(const Picture&) = delete;
  guint8 at(guint component, int x, int y) const {
    return static_cast<guint8*>(
        GST_VIDEO_FRAME_COMP_DATA(&frame, component))[y * GST_VIDEO_FRAME_COMP_STRIDE(&frame, component) +
                                                      x * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component)];
  }
  bool operator==(const Picture& other) const { return bytes(buffer) == bytes(other.buffer); }
};

inline GstBuffer* noise(const GstVideoInfo& info, int number) {
  GstBuffer* buffer = frame(info, number);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  guint32 state = 12345u + static_cast<guint32>(number);
  for (gsize i = 0; i < map.size; ++i) {
    state = state * 1664525u + 1013904223u;
    map.data[i] = static_cast<guint8>(state >> 24);
  }
  gst_buffer_unmap(buffer, &map);
  return buffer;
}

inline CerberusPose pose(double pan, double tilt = 0, GstClockTime from = 0,
                         GstClockTime until = GST_CLOCK_TIME_NONE) {
  CerberusPose p;
  cerberus_pose_init(&p);
  p.pan = pan, p.tilt = tilt;
  p.valid_from = from, p.valid_until = until;
  return p;
}

inline void send(GstHarness* h, const CerberusPose& p) {
  gst_harness_push_upstream_event(h, cerberus_event_new_pose(&p));
}

struct Ptz {
  Harness h;
  GstVideoInfo in = info_of(caps_string("I420", kWidth, kHeight)),
               out = info_of(caps_string("I420", kWindowWidth, kWindowHeight));
  explicit Ptz(const std::string& line = kLine, bool live = true, const char* format = "I420")
      : h(harness(line.c_str())) {
    in = info_of(caps_string(format, kWidth, kHeight));
    out = info_of(caps_string(format, kWindowWidth, kWindowHeight));
    gst_harness_set_live(h.get(), live);
    gst_harness_set_src_caps_str(h.get(), caps_string(format, kWidth, kHeight).c_str());
  }
  GstBuffer* through(int number) {
    fail_unless_equals_int(gst_harness_push(h.get(), noise(in, number)), GST_FLOW_OK);
    return gst_harness_pull(h.get());
  }
  // Fails unless the window lies at (left, top) on frame `number`.
  void shows(GstBuffer* window, int number, int left, int top) {
    const Picture seen(out, window), whole(in, noise(in, number));
    int wrong = 0;  // fail_unless() writes to a pipe each time
    for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&seen.frame); ++c) {
      const int sub_x = GST_VIDEO_FORMAT_INFO_W_SUB(in.finfo, c),
                sub_y = GST_VIDEO_FORMAT_INFO_H_SUB(in.finfo, c);
      for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&seen.frame, c); ++y)
        for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&seen.frame, c); ++x)
          wrong += seen.at(c, x, y) != whole.at(c, x + (left >> sub_x), y + (top >> sub_y));
    }
    fail_unless_equals_int(wrong, 0);
  }
  void frame_shows(int number, int left, int top) { shows(through(number), number, left, top); }
};

}  // namespace ptz_rig
