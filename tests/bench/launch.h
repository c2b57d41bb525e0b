// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

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

}  // namespace cerberus::bench
