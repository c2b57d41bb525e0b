// SPDX-License-Identifier: LGPL-2.1-or-later
// The thread that lets a clock's time pass, with a clock that stands still unless the test turns it.
#include "../../plugins/pantilt/ticker.hpp"

#include <future>  // before gstcheck.h, whose macro `fail` breaks it

#include <gst/check/gstcheck.h>
#include <gst/check/gsttestclock.h>

#include "support.h"

namespace {

using cerberus::plugin::Ticker;

struct Clock {
  GstClock* clock = gst_test_clock_new();
  ~Clock() { gst_object_unref(clock); }
  // Returns when a thread waits for that time.
  void await(GstClockTime time) const {
    GstClockID id = nullptr;
    gst_test_clock_wait_for_next_pending_id(GST_TEST_CLOCK(clock), &id);
    fail_unless_equals_uint64(gst_clock_id_get_time(id), time);
    gst_clock_id_unref(id);
  }
};

// The n-th call has been made.
struct Calls {
  int count = 0, awaited = 0;
  std::promise<void> there;
  void await(int n) { awaited = n; }
  void made() {
    if (++count == awaited) there.set_value();
  }
};

}  // namespace

GST_START_TEST(a_call_comes_when_the_last_one_said) {
  const Clock clock;
  Ticker ticker;
  ticker.start(clock.clock, [](GstClockTime time) { return time + GST_SECOND; });
  for (const int second : {1, 2, 3}) {
    clock.await(second * GST_SECOND);
    fail_unless(gst_test_clock_crank(GST_TEST_CLOCK(clock.clock)));
  }
  ticker.stop();
}
GST_END_TEST

GST_START_TEST(a_wake_up_before_the_wait_is_not_lost) {
  const Clock clock;
  Ticker ticker;
  Calls calls;
  calls.await(2);
  ticker.start(clock.clock, [&](GstClockTime time) {
    calls.made();
    if (calls.count == 1) ticker.wake();
    return time + GST_SECOND;
  });
  calls.there.get_future().wait();
  ticker.stop();
}
GST_END_TEST

GST_START_TEST(a_wake_up_ends_the_wait) {
  const Clock clock;
  Ticker ticker;
  Calls calls;
  calls.await(2);
  ticker.start(clock.clock, [&](GstClockTime time) {
    calls.made();
    return time + GST_SECOND;
  });
  clock.await(GST_SECOND);
  ticker.wake();
  calls.there.get_future().wait();
  ticker.stop();
}
GST_END_TEST

GST_START_TEST(it_may_be_started_and_stopped_again_and_more_than_once) {
  const Clock clock;
  Ticker ticker;
  ticker.stop();
  ticker.wake();
  for (int k = 0; k < 100; ++k) {
    Calls first, second;
    first.await(1);
    ticker.start(clock.clock, [&](GstClockTime time) {
      first.made();
      return time + GST_SECOND;
    });
    ticker.start(clock.clock, [&](GstClockTime time) {  // it runs already
      second.made();
      return time + GST_SECOND;
    });
    first.there.get_future().wait();
    ticker.stop();
    ticker.stop();
    fail_unless_equals_int(second.count, 0);
  }
}
GST_END_TEST

static Suite* ticker_suite() {
  Suite* suite = suite_create("ticker");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_call_comes_when_the_last_one_said);
  tcase_add_test(tests, a_wake_up_before_the_wait_is_not_lost);
  tcase_add_test(tests, a_wake_up_ends_the_wait);
  tcase_add_test(tests, it_may_be_started_and_stopped_again_and_more_than_once);
  return suite;
}

GST_CHECK_MAIN(ticker)
