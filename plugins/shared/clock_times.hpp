// SPDX-License-Identifier: LGPL-2.1-or-later
// Converts GStreamer's times to lib's and back; queries clock and liveness.
#pragma once

#include <gst/gst.h>

#include <algorithm>
#include <chrono>
#include <optional>

namespace cerberus::plugin {

constexpr GstClockTime clock_time(std::chrono::nanoseconds time) {
  return static_cast<GstClockTime>(time.count());
}
constexpr GstClockTime clock_time(std::optional<std::chrono::nanoseconds> time) {
  return time ? clock_time(*time) : GST_CLOCK_TIME_NONE;
}
constexpr GstClockTime clock_time(double seconds) {
  return static_cast<GstClockTime>(seconds * GST_SECOND + 0.5);
}
// Limited to a quarter of the range, 73 years, so that sums of some times do not overflow.
constexpr std::chrono::nanoseconds time_of(GstClockTime time) {
  return std::chrono::nanoseconds(static_cast<gint64>(std::min<GstClockTime>(time, G_MAXINT64 / 4)));
}

// The same; nothing for NONE.
constexpr std::optional<std::chrono::nanoseconds> known_time(GstClockTime time) {
  return GST_CLOCK_TIME_IS_VALID(time) ? std::optional(time_of(time)) : std::nullopt;
}

// Running time of a buffer; none where it has no time, or the stream's times are no times.
inline GstClockTime running_time_of(const GstSegment& segment, GstBuffer* buffer) {
  if (segment.format != GST_FORMAT_TIME || !GST_BUFFER_PTS_IS_VALID(buffer)) return GST_CLOCK_TIME_NONE;
  return gst_segment_to_running_time(&segment, GST_FORMAT_TIME, GST_BUFFER_PTS(buffer));
}

// Running time by the clock, while there is one.
inline std::optional<std::chrono::nanoseconds> clock_now(gpointer element) {
  const GstClockTime time = gst_element_get_current_running_time(GST_ELEMENT(element));
  if (!GST_CLOCK_TIME_IS_VALID(time)) return std::nullopt;
  return time_of(time);
}

// Returns whether the source upstream of a sink pad is live; nullopt without an answer (v4l2src without a frame rate):
// the caller then must not wait, and may query again.
inline std::optional<bool> is_live(GstPad* sinkpad) {
  g_autoptr(GstQuery) query = gst_query_new_latency();
  std::optional<bool> live;
  if (gst_pad_peer_query(sinkpad, query)) {
    gboolean answer = FALSE;
    gst_query_parse_latency(query, &answer, nullptr, nullptr);
    live = answer != FALSE;
  }
  return live;
}

}  // namespace cerberus::plugin
