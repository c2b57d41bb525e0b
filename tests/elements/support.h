// SPDX-License-Identifier: LGPL-2.1-or-later
// What element tests share.
#pragma once

#include <limits>
#include <string>

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

// Every format that our elements take.
// The first kByteFormatCount have samples of a byte, the others in words of 16 bits.
inline constexpr const char* kFormats[] = {
    "GRAY8",     "I420",      "YV12",      "NV12",      "NV21",      "Y41B",      "Y42B",
    "Y444",      "YUY2",      "UYVY",      "RGB",       "BGR",       "RGBx",      "BGRx",
    "xRGB",      "xBGR",      "RGBA",      "BGRA",      "ARGB",      "ABGR",      "P010_10LE",
    "P010_10BE", "P012_LE",   "P012_BE",   "P016_LE",   "P016_BE",   "I420_10LE", "I420_10BE",
    "I420_12LE", "I420_12BE", "I422_10LE", "I422_10BE", "I422_12LE", "I422_12BE", "Y444_10LE",
    "Y444_10BE", "Y444_12LE", "Y444_12BE", "Y444_16LE", "Y444_16BE", "GRAY16_LE", "GRAY16_BE"};
inline constexpr int kByteFormatCount = 20;

// A sample of a mapped frame (in samples of its component) as 8 bits, whatever its depth.
inline int sample_at(const GstVideoFrame* f, guint component, int x, int y) {
  const GstVideoFormatInfo* format = f->info.finfo;
  const auto* p = static_cast<const guint8*>(GST_VIDEO_FRAME_COMP_DATA(f, component)) +
                  static_cast<gssize>(y) * GST_VIDEO_FRAME_COMP_STRIDE(f, component) +
                  x * GST_VIDEO_FRAME_COMP_PSTRIDE(f, component);
  const int depth = GST_VIDEO_FORMAT_INFO_DEPTH(format, component);
  if (depth <= 8) return *p;
  p += GST_VIDEO_FRAME_COMP_POFFSET(f, component) % 2;  // GStreamer states 1 for V of P010, and means 2
  const int word = GST_VIDEO_FORMAT_INFO_IS_LE(format) ? GST_READ_UINT16_LE(p) : GST_READ_UINT16_BE(p);
  return word >> (GST_VIDEO_FORMAT_INFO_SHIFT(format, component) + depth - 8);
}

inline void set_sample(GstVideoFrame* f, guint component, int x, int y, int level) {
  const GstVideoFormatInfo* format = f->info.finfo;
  auto* p = static_cast<guint8*>(GST_VIDEO_FRAME_COMP_DATA(f, component)) +
            static_cast<gssize>(y) * GST_VIDEO_FRAME_COMP_STRIDE(f, component) +
            x * GST_VIDEO_FRAME_COMP_PSTRIDE(f, component);
  const int depth = GST_VIDEO_FORMAT_INFO_DEPTH(format, component);
  const auto word =
      static_cast<guint16>(level << (GST_VIDEO_FORMAT_INFO_SHIFT(format, component) + MAX(depth, 8) - 8));
  if (depth > 8) p += GST_VIDEO_FRAME_COMP_POFFSET(f, component) % 2;
  if (depth <= 8)
    *p = static_cast<guint8>(level);
  else if (GST_VIDEO_FORMAT_INFO_IS_LE(format))
    GST_WRITE_UINT16_LE(p, word);
  else
    GST_WRITE_UINT16_BE(p, word);
}

// The base turns at `yaw_rate` degrees a second from `running_time` on.
inline GstEvent* base_event(double yaw_rate, GstClockTime running_time) {
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = yaw_rate;
  base.valid_from = running_time;
  return cerberus_event_new_base(&base);
}

// The base drives straight ahead at `speed` metres a second; its turn is not known.
inline GstEvent* drive_event(double speed, GstClockTime running_time) {
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = std::numeric_limits<double>::quiet_NaN();
  base.speed = speed;
  base.valid_from = running_time;
  return cerberus_event_new_base(&base);
}

// Nothing is written where `event` is another one.
inline bool parse_base(GstEvent* event, double* yaw_rate, GstClockTime* running_time) {
  g_autoptr(CerberusBase) base = cerberus_event_parse_base(event);
  if (base && yaw_rate) *yaw_rate = base->yaw_rate;
  if (base && running_time) *running_time = base->valid_from;
  return base != nullptr;
}

inline CerberusStamp stamp_at(GstClockTime running_time) {
  CerberusStamp stamp;
  cerberus_stamp_init(&stamp);
  stamp.running_time = running_time;
  return stamp;
}

// Of a message of ours.
inline GstClockTime running_time_of(GstMessage* message) {
  g_autoptr(CerberusStamp) stamp = cerberus_message_parse_stamp(message);
  fail_unless(stamp);
  return stamp->running_time;
}

inline GstEvent* fusion_event(const char* head, const CerberusFusion& fusion) {
  CerberusFusion sent = fusion;
  cerberus_fusion_set_head(&sent, head);
  return cerberus_event_new_fusion(&sent);
}

// The state's nick and the head of a message about a head; empty where `message` is another one.
struct HeadState {
  explicit HeadState(GstMessage* message) {
    g_autoptr(CerberusPantilt) pantilt = cerberus_message_parse_pantilt(message);
    if (!pantilt) return;
    state = cerberus_pantilt_state_get_nick(pantilt->state);
    head = pantilt->pose.head;
    reason = pantilt->reason;
  }
  std::string state, head, reason;
};

// A new segment, of time from 0 on.
inline void push_segment(GstHarness* h) {
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  fail_unless(gst_harness_push_event(h, gst_event_new_segment(&segment)));
}

// A flush, and the segment after it.
inline void push_flush(GstHarness* h) {
  fail_unless(gst_harness_push_event(h, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(h, gst_event_new_flush_stop(TRUE)));
  push_segment(h);
}

// gst-check watches the log of GStreamer and GLib only: a critical of our own library must fail a test as well, unless
// EXPECT_CRITICAL expects it. Call it at the start of a suite.
inline void watch_library_log() {
  g_log_set_handler(
      "Cerberus", static_cast<GLogLevelFlags>(G_LOG_LEVEL_CRITICAL | G_LOG_LEVEL_WARNING),
      [](const gchar*, GLogLevelFlags level, const gchar* message, gpointer) {
        if (level & G_LOG_LEVEL_CRITICAL) _gst_check_raised_critical = TRUE;
        if (level & G_LOG_LEVEL_WARNING) _gst_check_raised_warning = TRUE;
        if (!_gst_check_expecting_log) ck_abort_msg("Cerberus: %s", message);
      },
      nullptr);
}

// ASSERT_CRITICAL that also passes where warnings end the program (the set-up that looks for leaks).
#define EXPECT_CRITICAL(code)                                               \
  do {                                                                      \
    const GLogLevelFlags fatal = g_log_set_always_fatal(G_LOG_LEVEL_ERROR); \
    ASSERT_CRITICAL(code);                                                  \
    g_log_set_always_fatal(fatal);                                          \
  } while (0)
