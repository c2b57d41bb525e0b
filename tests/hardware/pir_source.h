// SPDX-License-Identifier: LGPL-2.1-or-later
// A pirsrc on hardware that the kernel simulates, and what the tests ask of it.
#pragma once

#include "simulated.h"  // before gst-check, whose macros C++ streams cannot bear

#include <cerberus/pir.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>

#include <algorithm>
#include <string>
#include <vector>

namespace simulated {

using Bytes = std::vector<int>;

// A pirsrc with a pad that takes what it sends.
class Source {
 public:
  explicit Source(const std::string& properties) {
    const std::string line = "pirsrc " + properties;
    element_ = gst_parse_launch(line.c_str(), nullptr);
    fail_unless(element_ != nullptr, "%s cannot be made", line.c_str());
    harness_ = gst_harness_new_with_element(element_, nullptr, "src");
    gst_harness_use_systemclock(harness_);
    bus_ = gst_bus_new();
    gst_element_set_bus(element_, bus_);
  }
  ~Source() {
    gst_element_set_state(element_, GST_STATE_NULL);
    gst_element_set_bus(element_, nullptr);
    gst_harness_teardown(harness_);
    gst_object_unref(bus_);
    gst_object_unref(element_);
  }
  Source(const Source&) = delete;

  GstElement* element() const { return element_; }
  GstHarness* harness() const { return harness_; }
  void wants(const char* caps) { gst_harness_set_sink_caps_str(harness_, caps); }
  void play() { gst_harness_play(harness_); }
  GstClockTime now() const {
    GstClock* clock = gst_element_get_clock(element_);
    const GstClockTime time = gst_clock_get_time(clock) - gst_element_get_base_time(element_);
    gst_object_unref(clock);
    return time;
  }
  // The next buffer's readings; `when` = its time.
  Bytes reading(GstClockTime* when = nullptr) {
    GstBuffer* buffer = gst_harness_pull(harness_);
    fail_unless(buffer != nullptr, "no buffer came");
    if (when) *when = GST_BUFFER_PTS(buffer);
    guint8 bytes[CERBERUS_PIR_MAX_SENSORS];
    const gsize size = gst_buffer_extract(buffer, 0, bytes, sizeof bytes);
    gst_buffer_unref(buffer);
    return Bytes(bytes, bytes + size);
  }
  // Waits for these readings, which must come with the next change.
  GstClockTime expect(const Bytes& expected) {
    const Bytes before = last_;
    GstClockTime when = 0;
    do last_ = reading(&when);
    while (last_ == before && last_ != expected);
    fail_unless(last_ == expected, "%s came, not %s", text(last_).c_str(), text(expected).c_str());
    return when;
  }
  std::string message(GstMessageType type, GQuark domain = 0, gint code = 0) {
    GstMessage* message = gst_bus_timed_pop_filtered(bus_, 60 * GST_SECOND, type);
    fail_unless(message != nullptr, "no message");
    GError* error = nullptr;
    type == GST_MESSAGE_ERROR ? gst_message_parse_error(message, &error, nullptr)
                              : gst_message_parse_warning(message, &error, nullptr);
    const std::string said = error->message;
    if (domain) fail_unless(g_error_matches(error, domain, code), "code %d: %s", error->code, said.c_str());
    g_error_free(error);
    gst_message_unref(message);
    return said;
  }
  // Starting fails; what it said.
  std::string refusal(gint code) {
    fail_unless_equals_int(gst_element_set_state(element_, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
    return message(GST_MESSAGE_ERROR, GST_RESOURCE_ERROR, code);
  }

 private:
  static std::string text(const Bytes& bytes) {
    std::string all;
    for (const int byte : bytes) all += std::to_string(byte);
    return all;
  }
  GstElement* element_ = nullptr;
  GstHarness* harness_ = nullptr;
  GstBus* bus_ = nullptr;
  Bytes last_;
};

inline bool says(const std::string& text, const std::string& what) {
  if (text.find(what) != std::string::npos) return true;
  g_printerr("\"%s\" does not say \"%s\"\n", text.c_str(), what.c_str());
  return false;
}

struct Span {
  GstClockTime before, after;
};

// The kernel stamped it while it happened. A millisecond: the two clocks cannot be read at the same moment.
inline void must_be_of(GstClockTime when, const Span& span) {
  fail_unless(when + GST_MSECOND >= span.before && when <= span.after + GST_MSECOND,
              "stamped %" GST_TIME_FORMAT ", happened %" GST_TIME_FORMAT " to %" GST_TIME_FORMAT,
              GST_TIME_ARGS(when), GST_TIME_ARGS(span.before), GST_TIME_ARGS(span.after));
}

// A bound that is promised, on a machine within a machine that may be busy: of many rounds one must keep it.
template <typename Round>
GstClockTime least_of(GstClockTime promised, Round&& round) {
  GstClockTime least = GST_CLOCK_TIME_NONE;
  for (int i = 0; i < 20 && least >= promised; ++i) least = std::min<GstClockTime>(least, round());
  return least;
}

}  // namespace simulated
