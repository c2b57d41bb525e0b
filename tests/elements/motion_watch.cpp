// SPDX-License-Identifier: LGPL-2.1-or-later
// MotionWatch by itself: its timer across a flush, the end of a stream while the clock's thread delivers, and what its
// queue drops.
#include "../../plugins/detect/motion_watch.hpp"

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "support.h"

#include <gst/check/gsttestclock.h>

namespace {

using cerberus::plugin::MotionWatch;
using namespace std::chrono_literals;

CerberusRegion region(guint id) {
  CerberusRegion region;
  cerberus_region_init(&region);
  region.id = id;
  region.tracked = TRUE;
  region.width = region.height = 10;
  return region;
}

// A watch on an element with a clock that goes by hand. Frames come every 40 ms.
struct Watched {
  GstElement* element = gst_element_factory_make("identity", nullptr);
  GstBus* bus = gst_bus_new();
  GstTestClock* clock = GST_TEST_CLOCK(gst_test_clock_new());
  MotionWatch watch;
  GstClockTime now = 0;
  std::string seen;  // of messages: state or "id state"
  std::function<void(const std::string&)> on_message;

  Watched() {
    gst_element_set_bus(element, bus);
    gst_element_set_clock(element, GST_CLOCK(clock));
    gst_bus_set_sync_handler(
        bus,
        [](GstBus*, GstMessage* message, gpointer data) {
          static_cast<Watched*>(data)->note(message);
          gst_message_unref(message);
          return GST_BUS_DROP;
        },
        this, nullptr);
    watch.begin(element);
    watch.play(true);
  }
  ~Watched() {
    watch.end();
    gst_bus_set_sync_handler(bus, nullptr, nullptr, nullptr);
    gst_element_set_bus(element, nullptr);
    gst_object_unref(element);
    gst_object_unref(bus);
    gst_object_unref(clock);
  }
  void note(GstMessage* message) {
    std::string text;
    if (g_autoptr(CerberusMotion) motion = cerberus_message_parse_motion(message))
      text = cerberus_motion_state_get_nick(motion->state);
    if (g_autoptr(CerberusTrack) track = cerberus_message_parse_track(message))
      text = std::to_string(track->region.id) + cerberus_track_state_get_nick(track->state);
    seen += text + " ";
    if (on_message) on_message(text);
  }
  bool has(const std::string& text) const { return (" " + seen).find(" " + text + " ") != std::string::npos; }
  void frame(const std::vector<CerberusRegion>& regions, MotionWatch::Time step = 40ms) {
    now += static_cast<GstClockTime>(step.count());
    watch.frame(regions, stamp_at(now), step, 2s, true);
  }
  guint timers() const { return gst_test_clock_peek_id_count(clock); }
};

GST_START_TEST(a_frame_that_was_in_work_when_a_flush_began_sets_no_timer) {
  Watched stream;
  stream.frame({region(1)});
  fail_unless_equals_int(stream.timers(), 1);
  stream.watch.flush(true);
  fail_unless_equals_int(stream.timers(), 0);
  stream.frame({region(1)});
  fail_unless_equals_int(stream.timers(), 0);
}
GST_END_TEST

GST_START_TEST(motion_ends_by_the_clock_when_no_frame_follows_a_flush) {
  Watched stream;
  stream.frame({region(1)});
  stream.watch.flush(true);
  stream.watch.flush(false);
  fail_unless_equals_int(stream.timers(), 1);
  gst_test_clock_set_time(stream.clock, 2 * GST_SECOND);
  fail_unless(gst_test_clock_crank(stream.clock));
  fail_unless(stream.has("ended"), "%s", stream.seen.c_str());
}
GST_END_TEST

GST_START_TEST(a_flush_of_a_stream_without_motion_sets_no_timer) {
  Watched stream;
  stream.frame({});
  stream.watch.flush(true);
  stream.watch.flush(false);
  fail_unless_equals_int(stream.timers(), 0);
}
GST_END_TEST

// The clock's thread is kept inside the delivery of `ended`; the end of the stream waits for it. The wait has a limit,
// which is the only time that passes here: without the wait in end(), it is cut short and the test fails.
GST_START_TEST(the_end_of_the_stream_waits_until_the_clocks_thread_has_delivered) {
  Watched stream;
  stream.frame({region(1)});
  std::mutex lock;
  std::condition_variable changed;
  bool delivering = false, over = false, delivered = false;
  stream.on_message = [&](const std::string& text) {
    if (text != "ended") return;
    std::unique_lock guard(lock);
    delivering = true;
    changed.notify_all();
    changed.wait_for(guard, 200ms, [&] { return over; });
    delivered = true;
  };
  gst_test_clock_set_time(stream.clock, 2 * GST_SECOND);
  std::thread clock([&] { gst_test_clock_crank(stream.clock); });
  {
    std::unique_lock guard(lock);
    changed.wait(guard, [&] { return delivering; });
  }
  stream.watch.end();
  {
    const std::lock_guard guard(lock);
    over = true;
    fail_unless(delivered);
    changed.notify_all();
  }
  clock.join();
}
GST_END_TEST

// The receiver of a message may end the stream itself.
GST_START_TEST(the_end_of_the_stream_within_a_delivery_does_not_wait) {
  Watched stream;
  stream.on_message = [&](const std::string& text) {
    if (text == "started") stream.watch.end();
  };
  stream.frame({region(1)});
  fail_unless_equals_string(stream.seen.c_str(), "started 1appeared 1left ended ");
}
GST_END_TEST

// While a message is being delivered, 400 more arise: more than are kept. Updates of one track replace each other, and
// what happens once is kept.
GST_START_TEST(a_full_queue_drops_updates_that_newer_ones_replace) {
  Watched stream;
  stream.on_message = [&](const std::string& text) {
    if (text != "started") return;
    stream.frame({region(1), region(2)}, 1s);
    for (int k = 0; k < 400; ++k) stream.frame({region(1)}, 1s);
  };
  stream.frame({region(1)});
  for (const char* text : {"started", "1appeared", "2appeared", "2left", "1updated"})
    fail_unless(stream.has(text), "%s is missing", text);
  stream.watch.end();
  fail_unless(stream.has("1left") && stream.has("ended"));
}
GST_END_TEST

Suite* motion_watch_suite() {
  Suite* suite = suite_create("motion_watch");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, a_frame_that_was_in_work_when_a_flush_began_sets_no_timer);
  tcase_add_test(tests, motion_ends_by_the_clock_when_no_frame_follows_a_flush);
  tcase_add_test(tests, a_flush_of_a_stream_without_motion_sets_no_timer);
  tcase_add_test(tests, the_end_of_the_stream_waits_until_the_clocks_thread_has_delivered);
  tcase_add_test(tests, the_end_of_the_stream_within_a_delivery_does_not_wait);
  tcase_add_test(tests, a_full_queue_drops_updates_that_newer_ones_replace);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(motion_watch);
