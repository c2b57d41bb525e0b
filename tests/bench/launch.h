// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gst/app/gstappsink.h>
#include <gst/gst.h>

#include <cstdio>
#include <string>

namespace cerberus::bench {

// The pipeline of a launch line; nullptr, and a word about it, where it is none.
inline GstElement* launch(const std::string& line) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  if (!error) return pipeline;
  std::fprintf(stderr, "bench: %s\n", error->message);
  g_clear_error(&error);
  if (pipeline) gst_object_unref(pipeline);
  return nullptr;
}

// The next that comes out of appsink `out`; nullptr at the end. An error
// ends it too, with a word about it: many leave the sink waiting for ever.
inline GstSample* pull(GstElement* pipeline, GstElement* out, bool& failed) {
  GstBus* bus = gst_element_get_bus(pipeline);
  GstSample* sample = nullptr;
  GstMessage* message = nullptr;
  while (!sample && !message && !gst_app_sink_is_eos(GST_APP_SINK(out))) {
    sample = gst_app_sink_try_pull_sample(GST_APP_SINK(out), 200 * GST_MSECOND);
    message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
  }
  if (!sample && !message) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);  // before the end
  gst_object_unref(bus);
  if (!message) return sample;
  GError* what = nullptr;
  gst_message_parse_error(message, &what, nullptr);
  std::fprintf(stderr, "bench: %s\n", what->message);
  g_clear_error(&what);
  gst_message_unref(message);
  if (sample) gst_sample_unref(sample);
  failed = true;
  return nullptr;
}

}  // namespace cerberus::bench
