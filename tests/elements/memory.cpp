// SPDX-License-Identifier: LGPL-2.1-or-later
// The budget, measured from outside: what the heap holds for several streams more, whoever took it.
#include <malloc.h>

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

// Sanitizers and valgrind have a heap of their own, of which mallinfo2() knows nothing.
bool heap_tells() {
  constexpr std::size_t kMuch = 300000;
  const std::size_t before = held();
  void* volatile some = g_malloc(kMuch);
  const bool tells = held() >= before + kMuch;
  g_free(some);
  return tells;
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

struct Size {
  int width, height;    // of a frame
  int analysis_height;  // at 320 columns
};
constexpr Size kSizes[] = {{320, 240, 240}, {320, 180, 180}, {640, 360, 180}};

GST_START_TEST(a_stream_needs_at_most_24_bytes_an_analysis_pixel) {
  if (!heap_tells()) return;
  const Size& size = kSizes[__i__ / 2];
  // Kept planes are one more, of two bytes a pixel: the labels.
  const char* launch = __i__ % 2 ? "motiondetect keep-planes=always" : "motiondetect";
  const std::string caps = scene::caps("GRAY8", size.width, size.height);
  const std::vector<GstBuffer*> frames = film(size.width, size.height);
  std::vector<GstHarness*> streams = {stream(launch, frames, caps), stream(kNothing, frames, caps)};
  streams.reserve(2 * kStreams + 2);
  const std::size_t before = held();
  for (int n = 0; n < kStreams; ++n) streams.push_back(stream(kNothing, frames, caps));
  const std::size_t between = held();
  for (int n = 0; n < kStreams; ++n) streams.push_back(stream(launch, frames, caps));
  const double all = static_cast<double>(held() - between) - static_cast<double>(between - before);
  const double used = all / kStreams / (320.0 * size.analysis_height);
  g_print("%s, %d x %d: %.2f bytes an analysis pixel\n", launch, size.width, size.height, used);
  fail_unless(used > 10, "%.2f bytes an analysis pixel: that cannot be", used);
  fail_unless(used <= (__i__ % 2 ? 24 : 22), "%.2f bytes an analysis pixel at %d x %d", used, size.width,
              size.height);
  for (GstHarness* each : streams) gst_harness_teardown(each);
  for (GstBuffer* frame : frames) gst_buffer_unref(frame);
}
GST_END_TEST

// What is said of a frame is a few hundred bytes; the smallest plane has 57600.
GST_START_TEST(frames_that_wait_hold_no_planes) {
  if (!heap_tells()) return;
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
  tcase_add_loop_test(tests, a_stream_needs_at_most_24_bytes_an_analysis_pixel, 0, 6);
  tcase_add_test(tests, frames_that_wait_hold_no_planes);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(memory);
