// SPDX-License-Identifier: LGPL-2.1-or-later
// When and by which camera the frames of a stream were taken: the stamps of messages, JSON lines and buffers. This is
// the one place that makes them.
#pragma once

#include <cerberus/stamp.h>

#include <mutex>
#include <optional>
#include <string>

#include "shared/clock_times.hpp"

namespace cerberus::plugin {

inline constexpr char kCameraNameBlurb[] =
    "Name of the camera, for messages and JSON lines and for the elements behind; empty = as on the frame";

// Wall-clock time that rides on `buffer`: Unix or NTP time (since 1900) of a GstReferenceTimestampMeta.
inline GstClockTime reference_utc(GstBuffer* buffer) {
  static GstStaticCaps unix_caps = GST_STATIC_CAPS("timestamp/x-unix");
  static GstStaticCaps ntp_caps = GST_STATIC_CAPS("timestamp/x-ntp");
  constexpr GstClockTime kFrom1900To1970 = G_GUINT64_CONSTANT(2208988800) * GST_SECOND;
  const auto read = [&](GstStaticCaps& of) {
    g_autoptr(GstCaps) caps = gst_static_caps_get(&of);
    const auto* meta = gst_buffer_get_reference_timestamp_meta(buffer, caps);
    return meta ? meta->timestamp : GST_CLOCK_TIME_NONE;
  };
  if (const GstClockTime time = read(unix_caps); GST_CLOCK_TIME_IS_VALID(time)) return time;
  const GstClockTime time = read(ntp_caps);
  return GST_CLOCK_TIME_IS_VALID(time) && time >= kFrom1900To1970 ? time - kFrom1900To1970
                                                                  : GST_CLOCK_TIME_NONE;
}

// frame() is called in the streaming thread, at() in any.
class Stamps {
 public:
  // A stream begins: whether it is live is asked again.
  void reset() {
    const std::lock_guard guard(lock_);
    live_.reset();
    cerberus_stamp_init(&last_);
  }

  // The stamp of a frame that has arrived at `sink`. A stamp on the buffer has priority over its reference timestamp,
  // that over the system's clock, which counts in live streams only. A name of this element's own has priority.
  CerberusStamp frame(GstPad* sink, GstBuffer* buffer, GstClockTime running_time, const std::string& name) {
    CerberusStamp stamp;
    cerberus_stamp_init(&stamp);
    if (const CerberusStamp* carried = cerberus_buffer_peek_stamp(buffer)) stamp = *carried;
    stamp.running_time = running_time;
    if (!name.empty()) cerberus_stamp_set_camera_name(&stamp, name.c_str());
    if (!GST_CLOCK_TIME_IS_VALID(stamp.utc)) {
      stamp.utc = reference_utc(buffer);
      stamp.utc_source = CERBERUS_UTC_REFERENCE_TIMESTAMP;
    }
    if (!GST_CLOCK_TIME_IS_VALID(stamp.utc)) {
      if (!live_) live_ = is_live(sink);
      set_clock(stamp, live_.value_or(false));
    }
    const std::lock_guard guard(lock_);
    return last_ = stamp;
  }

  // As frame(), and attaches the stamp to `buffer`, which is writable, if it has more than the running time.
  CerberusStamp mark(GstPad* sink, GstBuffer* buffer, GstClockTime running_time, const std::string& name) {
    const CerberusStamp stamp = frame(sink, buffer, running_time, name);
    if (stamp.camera_name || GST_CLOCK_TIME_IS_VALID(stamp.utc)) cerberus_buffer_set_stamp(buffer, &stamp);
    return stamp;
  }

  // The stamp of another moment of the stream: wall-clock time as it runs from the last frame's.
  CerberusStamp at(GstClockTime running_time) const {
    const std::lock_guard guard(lock_);
    CerberusStamp stamp = last_;
    stamp.running_time = running_time;
    if (!GST_CLOCK_TIME_IS_VALID(stamp.utc)) return stamp;
    if (GST_CLOCK_TIME_IS_VALID(running_time) && GST_CLOCK_TIME_IS_VALID(last_.running_time))
      stamp.utc += running_time - last_.running_time;  // wraps back where it is earlier
    return stamp;
  }

  // Of a source, which has no frames: the system's clock now if it is live.
  static CerberusStamp now(GstClockTime running_time, bool live, const std::string& name) {
    CerberusStamp stamp;
    cerberus_stamp_init(&stamp);
    stamp.running_time = running_time;
    cerberus_stamp_set_camera_name(&stamp, name.c_str());
    set_clock(stamp, live);
    return stamp;
  }

 private:
  static void set_clock(CerberusStamp& stamp, bool live) {
    stamp.utc = live ? static_cast<GstClockTime>(g_get_real_time()) * GST_USECOND : GST_CLOCK_TIME_NONE;
    stamp.utc_source = live ? CERBERUS_UTC_CLOCK : CERBERUS_UTC_UNKNOWN;
  }

  std::optional<bool> live_;
  mutable std::mutex lock_;  // of last_
  CerberusStamp last_ = now(GST_CLOCK_TIME_NONE, false, {});
};

}  // namespace cerberus::plugin
