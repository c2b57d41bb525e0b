// SPDX-License-Identifier: LGPL-2.1-or-later
// The memory budget, measured from outside: the growth of the heap for several more streams, whatever allocates.
#include <malloc.h>

#include <algorithm>
#include <string>
#include <vector>

#include "scene.h"
#include "support.h"

namespace {

constexpr int kFrames = 60, kStreams = 6;

// Bytes that this process has taken from the heap and not given back, with what the heap itself needs for them.
std::size_t held() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

// Sanitizers and valgrind have heaps of their own, which mallinfo2() does not count; a tracer keeps its records on
// ours.
bool heap_is_measurable() {
  if (g_getenv("GST_TRACERS")) {
    g_print("left out: the tracer's records would be counted\n");
    return false;
  }
  constexpr std::size_t kMuch = 300000;
  const std::size_t before = held();
  void* volatile some = g_malloc(kMuch);
  const bool measurable = held() >= before + kMuch;
  g_free(some);
  return measurable;
}

std::vector<GstBuffer*> film(int width, int height) {
  scene::World world;
  world.width = width;
  world.height = height;
  world.pan = 1;
  std::vector<GstBuffer*> frames;
  for (int k = 0; k < kFrames; ++k) frames.push_back(scene::grey_buffer(world, k));
  return frames;
}

// A stream that has seen all frames and waits for more; `waiting`: so many of them have not been taken from its end.
GstHarness* stream(const char* launch, const std::vector<GstBuffer*>& frames, const std::string& caps,
                   int waiting = 0) {
  GstHarness* harness = gst_harness_new_parse(launch);
  gst_harness_set_src_caps_str(harness, caps.c_str());
  for (int k = 0; k < kFrames; ++k) {
    gst_harness_push(harness, gst_buffer_copy(frames[static_cast<std::size_t>(k)]));
    if (k < kFrames - waiting) gst_buffer_unref(gst_harness_pull(harness));
  }
  return harness;
}

// As many elements that keep nothing, where theirs is what is measured.
constexpr char kNothing[] = "identity ! identity ! identity ! identity ! identity";

constexpr char kUsual[] = "motiondetect";
// Four more: D(k-1) with the picture that it is of, and labels of two bytes.
constexpr char kKept[] = "motiondetect keep-planes=always";

struct Case {
  const char* launch;
  int width, height;  // of a frame
  double most;        // bytes an analysis pixel
  // The frame as it is analysed: 320 columns at most.
  double pixels() const {
    const double columns = std::min(width, 320);
    return columns * columns * height / width;
  }
};
// In a small picture much is what five elements are to GStreamer,
// and lists that do not depend on its size: about 60 kB, and 1 kB more with GStreamer 1.26.
constexpr Case kCases[] = {{kUsual, 320, 240, 20.5}, {kUsual, 320, 180, 20.8}, {kUsual, 640, 360, 21},
                           {kUsual, 160, 120, 24.5}, {kUsual, 160, 90, 25.7},  {kUsual, 128, 96, 26.7},
                           {kKept, 320, 240, 24.5},  {kKept, 640, 360, 25},    {kKept, 160, 120, 28.4}};

GST_START_TEST(a_stream_needs_at_most_its_bytes_an_analysis_pixel) {
  if (!heap_is_measurable()) return;
  const Case& c = kCases[__i__];
  const std::string caps = scene::caps("GRAY8", c.width, c.height);
  const std::vector<GstBuffer*> frames = film(c.width, c.height);
  std::vector<GstHarness*> streams = {stream(c.launch, frames, caps), stream(kNothing, frames, caps)};
  streams.reserve(2 * kStreams + 2);
  const std::size_t before = held();
  for (int n = 0; n < kStreams; ++n) streams.push_back(stream(kNothing, frames, caps));
  const std::size_t between = held();
  for (int n = 0; n < kStreams; ++n) streams.push_back(stream(c.launch, frames, caps));
  const double all = static_cast<double>(held() - between) - static_cast<double>(between - before);
  const double used = all / kStreams / c.pixels();
  g_print("%s, %d x %d: %.2f bytes an analysis pixel\n", c.launch, c.width, c.height, used);
  fail_unless(used > 10, "%.2f bytes an analysis pixel: that cannot be", used);
  fail_unless(used <= c.most, "%.2f bytes an analysis pixel at %d x %d", used, c.width, c.height);
  for (GstHarness* each : streams) gst_harness_teardown(each);
  for (GstBuffer* frame : frames) gst_buffer_unref(frame);
}
GST_END_TEST

// The annotations of a frame take a few hundred bytes; the smallest plane has 57600.
GST_START_TEST(frames_that_wait_hold_no_planes) {
  if (!heap_is_measurable()) return;
  constexpr int kWaiting = 50;
  const std::string caps = scene::caps("GRAY8", 320, 180);
  const std::vector<GstBuffer*> frames = film(320, 180);
  GstHarness* warm = stream("motiondetect", frames, caps);
  const std::size_t before = held();
  GstHarness* empty = stream("motiondetect", frames, caps);
  const std::size_t between = held();
  GstHarness* full = stream("motiondetect", frames, caps, kWaiting);
  const double more = static_cast<double>(held() - between) - static_cast<double>(between - before);
  g_print("%.0f bytes a frame that waits\n", more / kWaiting);
  fail_unless(more / kWaiting < 8000, "%.0f bytes a frame that waits", more / kWaiting);
  for (GstHarness* each : {warm, empty, full}) gst_harness_teardown(each);
  for (GstBuffer* frame : frames) gst_buffer_unref(frame);
}
GST_END_TEST

Suite* memory_suite() {
  Suite* suite = suite_create("memory");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 120);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, a_stream_needs_at_most_its_bytes_an_analysis_pixel, 0, G_N_ELEMENTS(kCases));
  tcase_add_test(tests, frames_that_wait_hold_no_planes);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(memory);
