// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frames.h"

#include <gst/video/video.h>
#include <time.h>

#include <algorithm>
#include <cstdio>

#include "launch.h"

namespace cerberus::bench {

std::size_t Frames::loop(std::size_t n) const {
  const std::size_t last = data.size() - 1;
  if (last == 0) return 0;
  const std::size_t i = n % (2 * last);
  return i <= last ? i : 2 * last - i;
}

std::optional<Frames> load_frames(const std::string& source, const char* format, int width, int height,
                                  int count) {
  std::string line = source + " ! videoconvert ! videoscale ! video/x-raw,format=" + format;
  if (width > 0) line += ",width=" + std::to_string(width) + ",height=" + std::to_string(height);
  line += ",pixel-aspect-ratio=1/1 ! appsink name=out sync=false max-buffers=4";
  GstElement* pipeline = launch(line);
  if (!pipeline) return std::nullopt;
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  Frames frames;
  bool failed = false;
  while (static_cast<int>(frames.data.size()) < count) {
    GstSample* sample = pull(pipeline, out, failed);
    if (!sample) break;
    if (frames.data.empty()) {
      GstCaps* caps = gst_caps_copy(gst_sample_get_caps(sample));
      GstStructure* s = gst_caps_get_structure(caps, 0);
      gst_structure_get_int(s, "width", &frames.width);
      gst_structure_get_int(s, "height", &frames.height);
      gst_structure_remove_field(s, "framerate");
      gchar* text = gst_caps_to_string(caps);
      frames.caps = text;
      g_free(text);
      gst_caps_unref(caps);
    }
    GstMapInfo map;
    GstBuffer* buffer = gst_sample_get_buffer(sample);
    if (gst_buffer_map(buffer, &map, GST_MAP_READ)) {
      frames.data.emplace_back(map.data, map.data + map.size);
      gst_buffer_unmap(buffer, &map);
    }
    gst_sample_unref(sample);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(out);
  gst_object_unref(pipeline);
  if (failed || frames.data.empty()) {
    std::fprintf(stderr, "bench: no frame from: %s\n", line.c_str());
    return std::nullopt;
  }
  return frames;
}

double thread_seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

}  // namespace cerberus::bench
