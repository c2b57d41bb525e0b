// SPDX-License-Identifier: LGPL-2.1-or-later
// A pirsrc, a consumer of its output, and its messages on the bus.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "says.h"

#include <cerberus/pir.h>
#include <gst/check/gstcheck.h>  // after the standard library, whose names its macros take
#include <gst/check/gstharness.h>

// Of a live source's first readings: a device that takes its time is still being opened.
inline bool nothing_is_known(const std::vector<int>& readings) {
  return std::ranges::all_of(readings, [](int reading) { return reading == 2; });
}

inline std::vector<int> readings_of(GstBuffer* buffer) {
  guint8 bytes[CERBERUS_PIR_MAX_SENSORS];
  const gsize size = gst_buffer_extract(buffer, 0, bytes, sizeof bytes);
  return {bytes, bytes + size};
}

class PirSource {
 public:
  // `line` begins with a pirsrc and has one source pad; `caps`: what is taken behind it, anything where none are named.
  explicit PirSource(const std::string& line, const char* caps = nullptr)
      : element_(gst_parse_bin_from_description(line.c_str(), TRUE, nullptr)) {
    fail_unless(element_ != nullptr, "%s cannot be made", line.c_str());
    gst_object_ref_sink(element_);
    harness_ = gst_harness_new_with_element(element_, nullptr, "src");
    if (caps) gst_harness_set_sink_caps_str(harness_, caps);
    gst_element_set_bus(element_, bus_);  // of a bin: what its children post comes too
  }
  ~PirSource() {
    gst_element_set_state(element_, GST_STATE_NULL);
    gst_element_set_bus(element_, nullptr);
    gst_harness_teardown(harness_);
    gst_object_unref(bus_);
    gst_object_unref(element_);
  }
  PirSource(const PirSource&) = delete;
  PirSource& operator=(const PirSource&) = delete;

  GstElement* element() const { return element_; }
  GstElement* child(const char* name) const {
    GstElement* child = gst_bin_get_by_name(GST_BIN(element_), name);
    fail_unless(child != nullptr, "there is no %s", name);
    gst_object_unref(child);  // the bin holds it
    return child;
  }
  GstHarness* harness() const { return harness_; }
  void play() { gst_harness_play(harness_); }

  // The next buffer, which must come.
  GstBuffer* take() {
    GstBuffer* buffer = gst_harness_pull(harness_);
    fail_unless(buffer != nullptr, "no buffer came");
    return buffer;
  }
  // The next message of this type, which must come.
  GstMessage* wait_for(GstMessageType type) {
    GstMessage* message = gst_bus_timed_pop_filtered(bus_, 60 * GST_SECOND, type);
    fail_unless(message != nullptr, "no such message came");
    return message;
  }
  // One that is there already; nullptr: there is none.
  GstMessage* pop(GstMessageType type) { return gst_bus_pop_filtered(bus_, type); }
  // Waits for an error or a warning, of this code if a domain is named; returns its text for the user.
  std::string words(GstMessageType type, GQuark domain = 0, gint code = 0) {
    GstMessage* message = wait_for(type);
    GError* error = nullptr;
    type == GST_MESSAGE_ERROR ? gst_message_parse_error(message, &error, nullptr)
                              : gst_message_parse_warning(message, &error, nullptr);
    const std::string text = error->message;
    if (domain) fail_unless(g_error_matches(error, domain, code), "code %d: %s", error->code, text.c_str());
    g_error_free(error);
    gst_message_unref(message);
    return text;
  }
  // It must not start, or fail later if its driver takes its time; returns the reason.
  std::string refusal(GQuark domain, gint code) {
    gst_element_set_state(element_, GST_STATE_PAUSED);
    const std::string why = words(GST_MESSAGE_ERROR, domain, code);
    fail_unless(pop(GST_MESSAGE_ERROR) == nullptr, "one message a failure");
    return why;
  }

 private:
  GstElement* element_;
  GstHarness* harness_ = nullptr;
  GstBus* bus_ = gst_bus_new();
};
