// SPDX-License-Identifier: LGPL-2.1-or-later
// A small world for element tests: a textured wall, and a textured figure that walks in front of it. The same grey
// levels in every format, so that every format must give the same answer.
#pragma once

// C++ first: check's macros (fail) bite standard headers.
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "records.h"

#include <cerberus/cerberus.h>
#include <gst/check/gstcheck.h>
#include <gst/check/gstharness.h>
#include <gst/video/video.h>

#include "support.h"

namespace scene {

// The corridor, and the bin of all of it.
inline constexpr const char* kElements[] = {"cameramotion",  "threeframediff", "fuzzythreshold",
                                            "motionregions", "motiontrack",    "motiondetect"};
inline constexpr int kElementCount = G_N_ELEMENTS(kElements);

constexpr int kWidth = 320, kHeight = 240;
constexpr int kFigureWidth = 28, kFigureHeight = 72;
constexpr GstClockTime kStep = GST_SECOND / 25;

inline std::uint32_t hash(std::uint32_t x, std::uint32_t y, std::uint32_t seed) {
  std::uint32_t h = x * 374761393u + y * 668265263u + seed * 2246822519u;
  h = (h ^ (h >> 13)) * 1274126177u;
  return h ^ (h >> 16);
}

// Value noise: random grey levels every `cell` pixels, bilinear between them.
inline double texture(double x, double y, int cell, std::uint32_t seed) {
  const double u = x / cell, v = y / cell;
  const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
  const double a = u - i, b = v - j;
  const auto level = [&](int p, int q) { return static_cast<double>(hash(p, q, seed) & 255); };
  return (1 - b) * ((1 - a) * level(i, j) + a * level(i + 1, j)) +
         b * ((1 - a) * level(i, j + 1) + a * level(i + 1, j + 1));
}

struct World {
  std::uint32_t wall = 1;  // another number is another place
  bool figure = true;
  double start = 30, speed = 3;  // left edge at frame 0, pixels a frame
  double pan = 0;                // pixels a frame by which the camera turns to the right
  int width = kWidth, height = kHeight;
  std::function<double(int)> path = {};  // left edge at a frame, in place of start and speed

  double figure_left(int frame) const { return (path ? path(frame) : start + speed * frame) - pan * frame; }
  double figure_top() const { return height * 0.4; }
  bool on_figure(int x, int y, int frame) const {
    const double left = figure_left(frame);
    return figure && x >= left && x < left + kFigureWidth && y >= figure_top() &&
           y < figure_top() + kFigureHeight;
  }
  std::vector<std::uint8_t> picture(int frame) const {
    std::vector<std::uint8_t> p = wall_from(pan * frame);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (on_figure(x, y, frame))
          p[static_cast<std::size_t>(y) * width + x] =
              static_cast<std::uint8_t>(150 + 0.35 * texture(x - figure_left(frame), y, 5, 77));
    return p;
  }
  // The wall alone, seen by a camera that has turned so far. Kept: texture costs more than all that looks at it.
  const std::vector<std::uint8_t>& wall_from(double turned) const {
    static std::map<std::tuple<std::uint32_t, int, int, double>, std::vector<std::uint8_t>> seen;
    std::vector<std::uint8_t>& p = seen[{wall, width, height, turned}];
    if (!p.empty()) return p;
    p.reserve(static_cast<std::size_t>(width) * height);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        p.push_back(static_cast<std::uint8_t>(30 + 0.35 * texture(x + turned, y, 9, wall)));
    return p;
  }
};

// The figure comes in from the left: wholly inside from frame 20 to 100.
inline World entering() {
  World world;
  world.start = -45;
  return world;
}

inline std::string caps(const char* format, int width, int height, const char* more = ",framerate=25/1") {
  return "video/x-raw,format=" + std::string(format) + ",width=" + std::to_string(width) +
         ",height=" + std::to_string(height) + more;
}

// Writes grey levels into a mapped frame of any of our formats: luma, or R = G = B; colourless, opaque.
inline void paint(GstVideoFrame* frame, const std::vector<std::uint8_t>& grey) {
  const bool rgb = GST_VIDEO_FORMAT_INFO_IS_RGB(frame->info.finfo);
  for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(frame); ++c) {
    const int width = GST_VIDEO_FRAME_COMP_WIDTH(frame, c), height = GST_VIDEO_FRAME_COMP_HEIGHT(frame, c);
    const bool bright = c == 0 || (rgb && c < 3);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        set_sample(frame, c, x, y,
                   bright   ? grey[static_cast<std::size_t>(y) * GST_VIDEO_FRAME_WIDTH(frame) + x]
                   : c == 3 ? 255
                            : 128);
  }
}

inline GstBuffer* buffer(const char* format, int width, int height, const std::vector<std::uint8_t>& grey,
                         GstClockTime pts) {
  GstVideoInfo info;
  gst_video_info_set_format(&info, gst_video_format_from_string(format), width, height);
  GstBuffer* out = gst_buffer_new_allocate(nullptr, info.size, nullptr);
  gst_buffer_memset(out, 0, 0, info.size);
  GstVideoFrame frame;
  fail_unless(gst_video_frame_map(&frame, &info, out, GST_MAP_WRITE));
  paint(&frame, grey);
  gst_video_frame_unmap(&frame);
  GST_BUFFER_PTS(out) = pts;
  GST_BUFFER_DURATION(out) = kStep;
  return out;
}

inline GstBuffer* grey_buffer(const World& world, int frame) {
  return buffer("GRAY8", world.width, world.height, world.picture(frame), frame * kStep);
}

// Pixels of the moving area in the record on the buffer.
inline long moving_pixels(GstBuffer* buffer) {
  const cerberus::vision::Record record = records::record_of(buffer);
  fail_unless(record && !record->mask().empty());
  const cerberus::vision::GrayView mask = record->mask();
  long pixels = 0, neither = 0;  // counted: an assertion for each pixel costs more than the detection
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      pixels += mask.at(x, y) != 0;
      neither += mask.at(x, y) != 0 && mask.at(x, y) != 255;
    }
  fail_unless_equals_int(neither, 0);
  return pixels;
}

struct Regions {
  explicit Regions(GstBuffer* buffer) : array(cerberus_buffer_get_regions(buffer)) {}
  ~Regions() { g_ptr_array_unref(array); }
  Regions(const Regions&) = delete;
  guint size() const { return array->len; }
  const CerberusRegion& operator[](guint i) const {
    return *static_cast<const CerberusRegion*>(g_ptr_array_index(array, i));
  }
  // All of them, printed: two answers are the same when their texts are.
  std::string text() const {
    std::string all;
    for (guint i = 0; i < size(); ++i) {
      gchar* line = g_strdup_printf("%u %.3f %.3f %.3f %.3f %.4f|", (*this)[i].id, (*this)[i].x, (*this)[i].y,
                                    (*this)[i].width, (*this)[i].height, (*this)[i].confidence);
      all += line;
      g_free(line);
    }
    return all;
  }
  GPtrArray* array;
};

inline bool overlaps_figure(const CerberusRegion& r, const World& world, int frame) {
  const double left = world.figure_left(frame), top = world.figure_top();
  return r.x < left + kFigureWidth && r.x + r.width > left && r.y < top + kFigureHeight &&
         r.y + r.height > top;
}

// A harness with caps, closed at the end of its life.
class Line {
 public:
  explicit Line(const std::string& launch, const std::string& caps_text = caps("GRAY8", kWidth, kHeight)) {
    harness = launch.find(' ') == std::string::npos ? gst_harness_new(launch.c_str())
                                                    : gst_harness_new_parse(launch.c_str());
    bus = gst_bus_new();
    gst_element_set_bus(harness->element, bus);
    if (!caps_text.empty()) gst_harness_set_src_caps_str(harness, caps_text.c_str());
  }
  ~Line() {
    gst_element_set_bus(harness->element, nullptr);
    gst_harness_teardown(harness);
    gst_object_unref(bus);
  }
  Line(const Line&) = delete;

  // Pushes and returns what comes out; fails the test when nothing does.
  GstBuffer* through(GstBuffer* in) {
    fail_unless_equals_int(gst_harness_push(harness, in), GST_FLOW_OK);
    GstBuffer* out = gst_harness_try_pull(harness);
    fail_unless(out != nullptr, "one buffer in, none out");
    return out;
  }
  void run(const World& world, int from, int to, const std::function<void(int, GstBuffer*)>& see = {}) {
    for (int frame = from; frame < to; ++frame) {
      GstBuffer* out = through(grey_buffer(world, frame));
      if (see) see(frame, out);
      gst_buffer_unref(out);
    }
  }
  void push_caps(const std::string& text) {
    GstCaps* caps = gst_caps_from_string(text.c_str());
    gst_harness_push_event(harness, gst_event_new_caps(caps));
    gst_caps_unref(caps);
  }
  // To READY and on again, with a new stream.
  void restart(const std::string& caps_text = caps("GRAY8", kWidth, kHeight)) {
    gst_element_set_state(harness->element, GST_STATE_READY);
    gst_element_set_state(harness->element, GST_STATE_PLAYING);
    gst_harness_push_event(harness, gst_event_new_stream_start("again"));
    push_caps(caps_text);
    push_segment(harness);
  }
  // The texts of the messages of this type posted so far (removes them); of element messages the states of motion.
  std::vector<std::string> messages(GstMessageType type) {
    std::vector<std::string> texts;
    while (GstMessage* message = gst_bus_pop_filtered(bus, type)) {
      if (type == GST_MESSAGE_ERROR || type == GST_MESSAGE_WARNING || type == GST_MESSAGE_INFO) {
        GError* error = nullptr;
        (type == GST_MESSAGE_ERROR     ? gst_message_parse_error
         : type == GST_MESSAGE_WARNING ? gst_message_parse_warning
                                       : gst_message_parse_info)(message, &error, nullptr);
        texts.emplace_back(error->message);
        g_error_free(error);
      } else {
        if (g_autoptr(CerberusMotion) motion = cerberus_message_parse_motion(message))
          texts.emplace_back(cerberus_motion_state_get_nick(motion->state));
      }
      gst_message_unref(message);
    }
    return texts;
  }

  GstHarness* harness;
  GstBus* bus;
};

}  // namespace scene
