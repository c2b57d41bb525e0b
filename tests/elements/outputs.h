// SPDX-License-Identifier: LGPL-2.1-or-later
// What the tests of motionjson, motionview and motionoverlay share: frames with metas made by hand.
#pragma once

// gst-check defines a macro `fail`, which C++ headers do not like: they come first.
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include "support.h"

namespace outputs {

inline std::string caps_string(const std::string& format, int width, int height, const char* more = "") {
  return "video/x-raw,format=" + format + ",width=" + std::to_string(width) +
         ",height=" + std::to_string(height) + ",framerate=25/1" + more;
}

inline GstVideoInfo info_of(const std::string& caps_text) {
  GstCaps* caps = gst_caps_from_string(caps_text.c_str());
  GstVideoInfo info;
  fail_unless(gst_video_info_from_caps(&info, caps), "%s", caps_text.c_str());
  gst_caps_unref(caps);
  return info;
}

// Frame `number` at 25 a second, every byte `value`; words of 16 bits mean the same level.
inline GstBuffer* frame(const GstVideoInfo& info, int number = 0, int value = 100) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  gst_buffer_memset(buffer, 0, static_cast<guint8>(value), info.size);
  GstVideoFrame f;
  if (GST_VIDEO_INFO_COMP_DEPTH(&info, 0) > 8 && gst_video_frame_map(&f, &info, buffer, GST_MAP_WRITE)) {
    for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&f); ++c)
      for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&f, c); ++y)
        for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&f, c); ++x) set_sample(&f, c, x, y, value);
    gst_video_frame_unmap(&f);
  }
  GST_BUFFER_PTS(buffer) = number * 40 * GST_MSECOND;
  GST_BUFFER_DURATION(buffer) = 40 * GST_MSECOND;
  return buffer;
}

inline CerberusRegion region(guint id, double x, double y, double width, double height) {
  CerberusRegion r;
  cerberus_region_init(&r);
  r.id = id;
  r.tracked = TRUE;
  r.x = x, r.y = y, r.width = width, r.height = height;
  r.confidence = 0.5;
  return r;
}

inline void add(GstBuffer* buffer, const CerberusRegion& r) {
  fail_unless(cerberus_buffer_add_region(buffer, &r));
}

inline std::vector<guint8> bytes(GstBuffer* buffer) {
  std::vector<guint8> all(gst_buffer_get_size(buffer));
  gst_buffer_extract(buffer, 0, all.data(), all.size());
  return all;
}

// assert_equals_string() looks at its arguments when temporaries are gone.
inline void expect(const std::string& is, const std::string& should) {
  fail_unless(is == should, "is       %s\nshould be %s", is.c_str(), should.c_str());
}

struct HarnessDeleter {
  void operator()(GstHarness* h) const { gst_harness_teardown(h); }
};
using Harness = std::unique_ptr<GstHarness, HarnessDeleter>;
inline Harness harness(const char* line) {
  return Harness(gst_harness_new_parse(line));
}

// Messages of `type` that the harness' element posted; to be watched from the start.
struct Bus {
  GstElement* element;
  GstBus* bus = gst_bus_new();
  explicit Bus(GstHarness* h) : element(h->element) { gst_element_set_bus(element, bus); }
  ~Bus() {
    gst_element_set_bus(element, nullptr);
    gst_bus_set_flushing(bus, TRUE);  // messages hold the element, which holds the bus
    gst_object_unref(bus);
  }
  int count(GstMessageType type, std::string* text = nullptr) {
    int n = 0;
    while (GstMessage* message = gst_bus_pop_filtered(bus, type)) {
      if (text && (type & (GST_MESSAGE_ERROR | GST_MESSAGE_WARNING))) {
        GError* error = nullptr;
        gchar* debug = nullptr;
        (type & GST_MESSAGE_ERROR ? gst_message_parse_error : gst_message_parse_warning)(message, &error,
                                                                                         &debug);
        *text = error->message;
        g_clear_error(&error);
        g_free(debug);
      }
      gst_message_unref(message);
      ++n;
    }
    return n;
  }
};

// Whether an event of this type came out since the last call.
inline bool event_came(GstHarness* h, GstEventType type) {
  bool came = false;
  while (GstEvent* event = gst_harness_try_pull_event(h)) {
    came = came || GST_EVENT_TYPE(event) == type;
    gst_event_unref(event);
  }
  return came;
}

}  // namespace outputs
