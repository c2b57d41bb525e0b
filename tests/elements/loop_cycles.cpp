// SPDX-License-Identifier: LGPL-2.1-or-later
// A thousand pipelines of all these elements begin and end, in every way, and leave nothing: no thread, no descriptor,
// no memory. (Objects that stay alive are found by the leak tracer, tests/run leaks.)
#include <malloc.h>

#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <thread>

// gst-check's macros bite standard headers: last.
#include "../support/entries.h"
#include "loop.h"

namespace {

// Instruments make a pipeline ten times as slow, and they look closer.
int pipelines() {
#if defined(__SANITIZE_ADDRESS__)
  return 100;
#else
  return std::getenv("GST_TRACERS") ? 100 : 1000;
#endif
}

struct Holds {
  int threads, descriptors;
  std::size_t bytes;
};

Holds held() {
  g_thread_pool_stop_unused_threads();
  return {entries("/proc/self/task"), entries("/proc/self/fd"), mallinfo2().uordblks};
}

// A thread of GLib's pool that was asked to end needs some time; a leaked one never ends.
Holds held_in_the_end(int threads) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  Holds now = held();
  while (now.threads > threads && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    now = held();
  }
  return now;
}

std::string all_elements(bool live, bool queues) {
  const std::string link = queues ? " ! queue ! " : " ! ", is_live = live ? "is-live=true" : "is-live=false";
  return loop::film(4, is_live, "200/1") +
         "virtualptz wide-fov=60 horizontal-fov=32.2 width=160 height=120 inset=true" + link +
         "motiondetect" + link + "pirfusion name=fusion" + link +
         "tee name=t pirsrc driver=scripted heartbeat=5000000 script=\"0,0,0,0; 0.005,0,1,0\" " + is_live +
         link + "fusion.pir_0 t." + link + "pantiltsink driver=simulated t." + link +
         "motionjson ! fakesink name=lines async=false t." + link + "motionoverlay ! fakesink async=false";
}

enum class End : std::uint8_t { at_once, in_the_middle, of_the_stream };

void play(loop::Pipeline& pipeline, End end) {
  pipeline.play();
  // In the middle: with the first decision; whatever the streams have come to by then.
  if (end == End::in_the_middle) pipeline.wait_for_message("cerberus-fusion");
  if (end == End::of_the_stream) pipeline.wait_for_end();
  pipeline.stop();
}

// Pipelines of every kind: live or not, with queues or without; each is used three times, with every end.
void run_pipelines(int from, int count) {
  for (int k = from; k < from + count; k += 3) {
    loop::Pipeline pipeline(all_elements(k & 1, k & 2));
    for (const End end : {End::at_once, End::of_the_stream, End::in_the_middle}) play(pipeline, end);
  }
}

GST_START_TEST(many_starts_and_stops_leave_nothing) {
  run_pipelines(0, 60);  // what is made once, is made
  const Holds before = held_in_the_end(1);
  const int count = pipelines();
  run_pipelines(0, count);
  const Holds after = held_in_the_end(before.threads);
  g_print("%d pipelines: %d threads and %d descriptors, then %d and %d; %.1f bytes each\n", count,
          before.threads, before.descriptors, after.threads, after.descriptors,
          (static_cast<double>(after.bytes) - static_cast<double>(before.bytes)) / count);
  fail_unless(after.threads <= before.threads, "%d threads more", after.threads - before.threads);
  fail_unless(after.descriptors <= before.descriptors, "%d descriptors more",
              after.descriptors - before.descriptors);
  // A GstObject or a buffer that is forgotten each time is more; the heap's own play is less.
  fail_unless(after.bytes < before.bytes + 65536 + 200 * static_cast<std::size_t>(count),
              "%zu bytes, then %zu", before.bytes, after.bytes);
}
GST_END_TEST

Suite* loop_cycles_suite() {
  Suite* suite = suite_create("loop_cycles");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 120);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, many_starts_and_stops_leave_nothing);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(loop_cycles);
