// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors whose driver hangs while it is opened: no change of state waits for it, the readings are invalid meanwhile,
// and the result is reported, however late.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <string>

#include "../support/entries.h"
#include "../support/pipe.h"
#include "../support/pir_source.h"
#include "promises.h"
#include "support.h"

namespace {

using cerberus::tests::Pipe;
using std::chrono::milliseconds;

constexpr char kTimes[] = "heartbeat=3600000000000 ";

// Its driver does not open before `gate` is closed.
class Hanging {
 public:
  explicit Hanging(const std::string& script, const std::string& properties = "", const char* caps = nullptr)
      : source("pirsrc min-pulse=0 name=source " + properties + " script=\"open wait " + gate.reader() +
                   "; " + script + "\"",
               caps) {}

  milliseconds change(GstState state) {
    return time_taken([&] {
      fail_if(gst_element_set_state(source.element(), state) == GST_STATE_CHANGE_FAILURE, "%s",
              gst_element_state_get_name(state));
    });
  }
  // The next buffer, as "100 222": milliseconds, readings.
  std::string next() {
    g_autoptr(GstBuffer) buffer = source.take();
    guint8 readings[CERBERUS_PIR_MAX_SENSORS];
    const gsize size = gst_buffer_extract(buffer, 0, readings, sizeof readings);
    std::string text = std::to_string(GST_BUFFER_PTS(buffer) / GST_MSECOND) + " ";
    for (gsize i = 0; i < size; ++i) text += std::to_string(readings[i]);
    return text;
  }
  void no_more_errors() { fail_unless(source.pop(GST_MESSAGE_ERROR) == nullptr, "one message a failure"); }
  void ends() {
    for (bool ended = false; !ended;) {
      g_autoptr(GstEvent) event = gst_harness_pull_event(source.harness());
      fail_unless(event != nullptr, "no EOS came");
      ended = GST_EVENT_TYPE(event) == GST_EVENT_EOS;
    }
  }

  Pipe gate;  // before what waits for it
  PirSource source;
};

void assert_next(Hanging& hanging, const char* expected) {
  const std::string reading = hanging.next();
  ck_assert_str_eq(reading.c_str(), expected);
}

int held() {
  g_thread_pool_stop_unused_threads();
  return entries("/proc/self/task") + entries("/proc/self/fd");
}

}  // namespace

GST_START_TEST(an_opening_that_hangs_delays_no_change_of_state) {
  constexpr std::array kStates = {GST_STATE_PAUSED, GST_STATE_PLAYING, GST_STATE_PAUSED, GST_STATE_READY};
  for (const char* live : {"is-live=true", "is-live=false"}) {
    std::array<milliseconds, kStates.size()> best;
    best.fill(milliseconds::max());
    for (int round = 0; round < kRounds && std::ranges::max(best) >= kPromised; ++round) {
      Hanging hanging("0,0,0,1", live);
      for (std::size_t k = 0; k < kStates.size(); ++k)
        best[k] = std::min(best[k], hanging.change(kStates[k]));
    }
    for (std::size_t k = 0; k < kStates.size(); ++k)
      fail_unless(best[k] < kPromised, "%s: %s takes %d ms", live, gst_element_state_get_name(kStates[k]),
                  static_cast<int>(best[k].count()));
  }
}
GST_END_TEST

GST_START_TEST(a_driver_that_hangs_and_does_not_fit_fails_in_time) {
  assert_prompt("a start that fails", [] {
    Hanging hanging("0,0,0,1", "is-live=true", "application/x-other");
    return time_taken([&] {
      fail_unless_equals_int(gst_element_set_state(hanging.source.element(), GST_STATE_PAUSED),
                             GST_STATE_CHANGE_FAILURE);
    });
  });
}
GST_END_TEST

void hang_and_leave() {
  for (const char* script : {"0,0,0,1", "open fail no such chip", "0,0,0,1; wait 0 0"}) {
    Hanging hanging(script, "is-live=true");
    hanging.change(GST_STATE_PLAYING);
    hanging.change(GST_STATE_NULL);
    hanging.no_more_errors();
  }
}

GST_START_TEST(a_driver_that_outlasts_its_source_leaves_nothing_when_it_returns) {
  hang_and_leave();
  const int before =
      held();  // GLib's own threads are there, and perhaps one of ours still: fewer than five times as many
  for (int round = 0; round < 5; ++round) hang_and_leave();
  for (int k = 0; k < 2000 && held() > before; ++k) g_usleep(10000);
  fail_unless(held() <= before, "%d, and there were %d", held(), before);
}
GST_END_TEST

GST_START_TEST(live_nothing_is_known_until_they_are_open) {
  Hanging hanging("0,0,0,1; 0.35,0,1,1", "is-live=true");
  hanging.source.play();
  assert_next(hanging, "0 222");
  for (const char* expected : {"100 222", "200 222"}) {
    gst_harness_set_time(hanging.source.harness(), std::stoull(expected) * GST_MSECOND);
    assert_next(hanging, expected);
  }
  fail_unless(gst_harness_try_pull(hanging.source.harness()) == nullptr);
  hanging.gate.close_writer();
  assert_next(hanging, "200 001");  // at once, the present reading
  gst_harness_set_time(hanging.source.harness(), 350 * GST_MSECOND);
  std::string reading;
  do reading = hanging.next();
  while (!reading.ends_with("011"));
  ck_assert_str_eq(reading.c_str(), "350 011");
}
GST_END_TEST

GST_START_TEST(a_device_is_read_as_soon_as_it_is_open) {
  Pipe gate, bell;
  Hanging hanging("0,0,0,1; 1,1,0,0; wait " + gate.reader() + " " + bell.writer(),
                  std::string("is-live=true ") + kTimes);
  gst_harness_use_systemclock(hanging.source.harness());
  hanging.source.play();
  fail_unless(hanging.next().ends_with(" 222"));
  hanging.gate.close_writer();
  fail_unless(hanging.next().ends_with(" 001"));
  bell.read();  // it blocks in its second read
  gate.close_writer();
  fail_unless(hanging.next().ends_with(" 101"));
  fail_unless(hanging.next().ends_with(" 100"));  // the fall counts after 20 ms of quiet
}
GST_END_TEST

GST_START_TEST(a_recording_is_the_same_however_late_it_opens) {
  Hanging hanging("0,0,0,1; 1,1,0,1; 2,1,0,0; 3,0,0,0", kTimes);
  hanging.change(GST_STATE_PLAYING);
  fail_unless(gst_harness_try_pull(hanging.source.harness()) == nullptr);
  hanging.gate.close_writer();
  for (const char* expected : {"0 001", "1000 101", "2020 100", "3020 000"}) assert_next(hanging, expected);
  hanging.ends();
}
GST_END_TEST

GST_START_TEST(a_recording_that_is_being_opened_can_be_sought_in) {
  Hanging hanging("0,0,0,1; 1,1,0,1; 2,1,0,0; 3,0,0,0", kTimes);
  hanging.change(GST_STATE_PAUSED);
  fail_unless(gst_harness_push_upstream_event(
      hanging.source.harness(), gst_event_new_seek(1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, GST_SEEK_TYPE_SET,
                                                   1500 * GST_MSECOND, GST_SEEK_TYPE_NONE, -1)));
  hanging.gate.close_writer();
  hanging.change(GST_STATE_PLAYING);
  for (const char* expected : {"1500 101", "2020 100", "3020 000"}) assert_next(hanging, expected);
  hanging.ends();
}
GST_END_TEST

GST_START_TEST(sensors_that_cannot_be_opened_are_reported_at_once_and_once_however_late) {
  for (const char* live : {"is-live=true", "is-live=false"}) {
    for (const GstState state : {GST_STATE_PAUSED, GST_STATE_PLAYING}) {
      Hanging hanging("open fail no such converter", live);
      hanging.change(state);
      hanging.no_more_errors();
      hanging.gate.close_writer();
      const std::string why =
          hanging.source.words(GST_MESSAGE_ERROR, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ);
      ck_assert_str_eq(why.c_str(), "no such converter");
      hanging.change(GST_STATE_PLAYING);
      hanging.ends();
      hanging.no_more_errors();
    }
  }
}
GST_END_TEST

// An application that stops at the first message that ends the stream must receive the error.
GST_START_TEST(no_end_of_the_stream_overtakes_the_error) {
  for (int round = 0; round < 5; ++round) {
    Hanging hanging("open fail no such converter", "is-live=true");
    std::atomic<bool> posted = false;
    GstBus* bus = gst_element_get_bus(hanging.source.element());
    gst_bus_set_sync_handler(
        bus,
        [](GstBus*, GstMessage* message, gpointer data) {
          if (GST_MESSAGE_TYPE(message) != GST_MESSAGE_ERROR) return GST_BUS_PASS;
          g_usleep(50000);
          *static_cast<std::atomic<bool>*>(data) = true;
          return GST_BUS_PASS;
        },
        &posted, nullptr);
    hanging.change(GST_STATE_PLAYING);
    hanging.gate.close_writer();
    hanging.ends();
    const bool first = posted;
    hanging.change(GST_STATE_NULL);
    gst_bus_set_sync_handler(bus, nullptr, nullptr, nullptr);
    gst_object_unref(bus);
    fail_unless(first);
  }
}
GST_END_TEST

GST_START_TEST(a_source_that_failed_may_be_started_again) {
  Hanging hanging("open fail no such converter", "is-live=true");
  for (int round = 0; round < 3; ++round) {  // after the first, at once: the gate is open
    if (gst_element_set_state(hanging.source.element(), GST_STATE_PAUSED) != GST_STATE_CHANGE_FAILURE)
      hanging.gate.close_writer();
    const std::string why = hanging.source.words(GST_MESSAGE_ERROR);
    ck_assert_str_eq(why.c_str(), "no such converter");
    gst_element_set_state(hanging.source.element(), GST_STATE_NULL);
    hanging.no_more_errors();
  }
}
GST_END_TEST

// The sensors' properties are known once they are open; an element downstream may have queried before.
GST_START_TEST(volts_that_are_not_measured_are_refused_however_late) {
  for (const char* live : {"is-live=true", "is-live=false"}) {
    Hanging hanging("0,0,0,1", live, "application/x-pir,format=level");
    hanging.change(GST_STATE_PLAYING);
    hanging.gate.close_writer();
    const std::string why =
        hanging.source.words(GST_MESSAGE_ERROR, GST_CORE_ERROR, GST_CORE_ERROR_NEGOTIATION);
    fail_unless(says(why, "driver=iio") && says(why, "format=(string)level"));
    hanging.no_more_errors();
  }
}
GST_END_TEST

GST_START_TEST(a_consumer_that_prefers_volts_gets_readings_where_there_are_none) {
  for (const bool volts : {true, false}) {
    Hanging hanging(volts ? "0,0V,0V,3V" : "0,0,0,1", kTimes,
                    "application/x-pir,format=level;application/x-pir");
    // Downstream's order counts: what it likes best comes first.
    gst_pad_set_query_function(
        hanging.source.harness()->sinkpad, [](GstPad* pad, GstObject* parent, GstQuery* query) -> gboolean {
          if (GST_QUERY_TYPE(query) != GST_QUERY_CAPS) return gst_pad_query_default(pad, parent, query);
          g_autoptr(GstCaps) caps =
              gst_caps_from_string("application/x-pir,format=level;application/x-pir,format=presence");
          GstCaps* filter = nullptr;
          gst_query_parse_caps(query, &filter);
          g_autoptr(GstCaps) both =
              filter ? gst_caps_intersect_full(caps, filter, GST_CAPS_INTERSECT_FIRST) : gst_caps_ref(caps);
          gst_query_set_caps_result(query, both);
          return TRUE;
        });
    hanging.change(GST_STATE_PLAYING);
    hanging.gate.close_writer();
    g_autoptr(GstBuffer) buffer = hanging.source.take();
    fail_unless_equals_uint64(gst_buffer_get_size(buffer), volts ? 3 * sizeof(float) : 3);
  }
}
GST_END_TEST

static Suite* pirsrc_opening_suite() {
  watch_library_log();
  Suite* suite = suite_create("pirsrc whose driver hangs while it is opened");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, an_opening_that_hangs_delays_no_change_of_state);
  tcase_add_test(tests, a_driver_that_hangs_and_does_not_fit_fails_in_time);
  tcase_add_test(tests, a_driver_that_outlasts_its_source_leaves_nothing_when_it_returns);
  tcase_add_test(tests, live_nothing_is_known_until_they_are_open);
  tcase_add_test(tests, a_device_is_read_as_soon_as_it_is_open);
  tcase_add_test(tests, a_recording_is_the_same_however_late_it_opens);
  tcase_add_test(tests, a_recording_that_is_being_opened_can_be_sought_in);
  tcase_add_test(tests, sensors_that_cannot_be_opened_are_reported_at_once_and_once_however_late);
  tcase_add_test(tests, no_end_of_the_stream_overtakes_the_error);
  tcase_add_test(tests, a_source_that_failed_may_be_started_again);
  tcase_add_test(tests, volts_that_are_not_measured_are_refused_however_late);
  tcase_add_test(tests, a_consumer_that_prefers_volts_gets_readings_where_there_are_none);
  return suite;
}

GST_CHECK_MAIN(pirsrc_opening)
