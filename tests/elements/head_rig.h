// SPDX-License-Identifier: LGPL-2.1-or-later
// A pantiltsink in a harness, and frames for it.
#pragma once

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/check/gsttestclock.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "../support/pipe.h"
#include "support.h"

namespace head_rig {

using cerberus::tests::Pipe;

inline constexpr GstClockTime kFrame = 40 * GST_MSECOND;
inline constexpr int kWidth = 320, kHeight = 240;

enum class Source { stored, live, silent };  // silent: does not say whether it is live

struct Person {
  guint id;
  double x, y, width, height;
  GstClockTime age = GST_SECOND;
  double distance = NAN;
};

// A frame with nothing on it.
inline GstBuffer* frame_at(GstClockTime pts, GstClockTime duration = kFrame) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, kWidth * kHeight, nullptr);
  GST_BUFFER_PTS(buffer) = pts;
  GST_BUFFER_DURATION(buffer) = duration;
  return buffer;
}

inline void add(GstBuffer* buffer, const Person& person) {
  CerberusRegion region;
  cerberus_region_init(&region);
  region.id = person.id;
  region.tracked = TRUE;
  region.x = person.x;
  region.y = person.y;
  region.width = person.width;
  region.height = person.height;
  region.age = person.age;
  region.distance = person.distance;
  cerberus_buffer_add_region(buffer, &region);
}

inline void add(GstBuffer* buffer, CerberusFusionAction action, guint target = 0, double from = NAN,
                double to = NAN) {
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.action = action;
  fusion.target = target;
  fusion.sector_from = from;
  fusion.sector_to = to;
  cerberus_buffer_set_fusion(buffer, &fusion);
}

// A frame with a fusion decision.
inline GstBuffer* frame_with(CerberusFusionAction action, GstClockTime pts = 0) {
  GstBuffer* buffer = frame_at(pts);
  add(buffer, action);
  return buffer;
}

// A person of 20x60 pixels whose middle is this many degrees right of the camera's axis, through a lens of 60 degrees.
inline Person person(guint id, double degrees_right) {
  const double focal = kWidth / 2.0 / std::tan(30 * std::numbers::pi / 180);
  const double middle = kWidth / 2.0 + focal * std::tan(degrees_right * std::numbers::pi / 180);
  return {.id = id, .x = middle - 10, .y = kHeight / 2.0 - 30, .width = 20, .height = 60};
}

// A name that no other head of this test has: a driver that is late to end, on a busy machine, still has its own.
inline std::string new_head() {
  static int heads = 0;
  return std::string("h").append(std::to_string(++heads));
}

// The scripted driver, on a head of its own.
inline std::string scripted(const std::string& script, const std::string& head = new_head()) {
  return "driver=scripted head=" + head + " script=\"" + script + "\"";
}

// Which way a line of the scripted driver's record turns the head: -1, 1, or 0.
inline int way_of(const std::string& line) {
  char kind[16];
  double value = 0;
  if (std::sscanf(line.c_str(), "command %*u %15s %lf", kind, &value) != 2) return 0;
  return value < 0 ? -1 : value > 0 ? 1 : 0;
}

struct Message {
  std::string state, reason;
  bool waits = false;  // for an order
  double pan;
};

class Rig {
 public:
  explicit Rig(const std::string& properties = "", Source source = Source::stored, bool at_once = true) {
    GError* error = nullptr;
    element = gst_parse_launch(("pantiltsink name=head " + properties).c_str(), &error);
    fail_unless(element && !error, "%s", error ? error->message : "");
    gst_object_ref_sink(element);
    bus = gst_bus_new();
    gst_element_set_bus(element, bus);
    harness = gst_harness_new_with_element(element, "sink", nullptr);
    if (source == Source::stored) gst_pad_set_query_function(harness->srcpad, not_live);
    if (source == Source::silent)
      gst_pad_set_query_function(harness->srcpad,
                                 [](GstPad*, GstObject*, GstQuery*) -> gboolean { return FALSE; });
    if (at_once) begin();
  }
  // Stream start, caps, segment.
  void begin() {
    gst_harness_set_src_caps_str(harness, "video/x-raw,format=GRAY8,width=320,height=240,framerate=25/1");
  }
  ~Rig() {
    gst_harness_teardown(harness);
    gst_element_set_bus(element, nullptr);
    gst_object_unref(bus);
    gst_object_unref(element);
  }
  Rig(const Rig&) = delete;

  void push(GstBuffer* buffer) { fail_unless_equals_int(gst_harness_push(harness, buffer), GST_FLOW_OK); }
  // The poses that have gone upstream since the last call.
  std::vector<CerberusPose> poses() {
    std::vector<CerberusPose> found;
    while (GstEvent* event = gst_harness_try_pull_upstream_event(harness)) take(event, found);
    return found;
  }
  CerberusPose next_pose() {
    std::vector<CerberusPose> found;
    while (found.empty()) {
      GstEvent* event = gst_harness_pull_upstream_event(harness);
      fail_unless(event != nullptr);
      take(event, found);
    }
    return found[0];
  }
  std::vector<Message> messages() {
    std::vector<Message> found;
    while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT)) {
      const GstStructure* s = gst_message_get_structure(message);
      if (gst_structure_has_name(s, CERBERUS_MESSAGE_PANTILT)) {
        Message& m = found.emplace_back();
        m.state = gst_structure_get_string(s, "state");
        m.reason = gst_structure_get_string(s, "reason");
        gst_structure_get_double(s, "pan", &m.pan);
        gboolean waits = FALSE;
        fail_unless(gst_structure_get_boolean(s, "waits-for-order", &waits));
        m.waits = waits;
      }
      gst_message_unref(message);
    }
    return found;
  }
  std::string states() {
    std::string all;
    for (const Message& message : messages()) all += (all.empty() ? "" : " ") + message.state;
    return all;
  }
  gboolean call(const char* signal) {
    gboolean done = FALSE;
    g_signal_emit_by_name(element, signal, &done);
    return done;
  }
  gboolean call(const char* signal, double pan, double tilt) {
    gboolean done = FALSE;
    g_signal_emit_by_name(element, signal, pan, tilt, &done);
    return done;
  }
  gboolean follow(guint id) {
    gboolean done = FALSE;
    g_signal_emit_by_name(element, "follow", id, &done);
    return done;
  }
  // The texts of the warnings since the last call, one a line. Like messages(), it discards all other messages.
  std::string warnings() {
    std::string all;
    while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_WARNING)) {
      GError* error = nullptr;
      gst_message_parse_warning(message, &error, nullptr);
      all.append(error->message).append("\n");
      g_error_free(error);
      gst_message_unref(message);
    }
    return all;
  }
  // Lets the clock go to the time that the element waits for, and that work be done.
  GstClockTime crank() const {
    g_autoptr(GstTestClock) clock = gst_harness_get_testclock(harness);
    fail_unless(gst_test_clock_crank(clock));
    gst_test_clock_wait_for_next_pending_id(clock, nullptr);
    return gst_clock_get_time(GST_CLOCK(clock));
  }
  GstClockTime time() const {
    g_autoptr(GstTestClock) clock = gst_harness_get_testclock(harness);
    return gst_clock_get_time(GST_CLOCK(clock));
  }

  GstElement* element;
  GstBus* bus;
  GstHarness* harness;

 private:
  static void take(GstEvent* event, std::vector<CerberusPose>& found) {
    if (CerberusPose* pose = cerberus_event_parse_pose(event)) {
      found.push_back(*pose);
      cerberus_pose_free(pose);
    }
    gst_event_unref(event);
  }
  static gboolean not_live(GstPad* pad, GstObject* parent, GstQuery* query) {
    if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY) return gst_pad_query_default(pad, parent, query);
    gst_query_set_latency(query, FALSE, 0, GST_CLOCK_TIME_NONE);
    return TRUE;
  }
};

// Pushes `count` frames with one action, from frame `first` on; returns every pose that is published meanwhile.
inline std::vector<CerberusPose> act(Rig& rig, CerberusFusionAction action, int first, int count,
                                     double from = NAN, double to = NAN) {
  std::vector<CerberusPose> all;
  for (int k = first; k < first + count; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    add(buffer, action, 0, from, to);
    rig.push(buffer);
    for (const CerberusPose& pose : rig.poses()) all.push_back(pose);
  }
  return all;
}

}  // namespace head_rig
