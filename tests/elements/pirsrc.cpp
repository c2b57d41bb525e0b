// SPDX-License-Identifier: LGPL-2.1-or-later
// pirsrc with recorded readings. What needs hardware is in tests/hardware.
#include <cerberus/base.h>
#include <cerberus/pir.h>
#include <glib/gstdio.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "fusion_rig.h"
#include "promises.h"

#include "../support/pir_source.h"

namespace {

constexpr char kWalk[] = "script=\"0,0,0,0; 0.25,1,0,0; 0.4,1,1,1; 0.45,0,1,1\"";

struct Buffer {
  GstClockTime pts;
  std::string readings;
};

std::string digits(gconstpointer bytes, gsize size) {
  std::string text;
  for (gsize i = 0; i < size; ++i) text += static_cast<char>('0' + static_cast<const guint8*>(bytes)[i]);
  return text;
}

class Source : public PirSource {
 public:
  // Of properties that do not say so every pulse counts, with the time of its edge.
  explicit Source(const std::string& properties) : PirSource("pirsrc min-pulse=0 " + properties) {}

  Buffer pull() {
    g_autoptr(GstBuffer) buffer = take();
    guint8 bytes[CERBERUS_PIR_MAX_SENSORS];
    return {GST_BUFFER_PTS(buffer), digits(bytes, gst_buffer_extract(buffer, 0, bytes, sizeof bytes))};
  }
  // All until EOS, as "250 100".
  std::vector<std::string> all() {
    std::vector<std::string> lines;
    play();
    wait_for_end();
    while (gst_harness_buffers_in_queue(harness()) > 0) {
      const Buffer buffer = pull();
      lines.push_back(std::to_string(buffer.pts / GST_MSECOND) + " " + buffer.readings);
    }
    return lines;
  }
  std::string error(GQuark domain, gint code) { return words(GST_MESSAGE_ERROR, domain, code); }
  std::string warning() { return words(GST_MESSAGE_WARNING, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ); }

 private:
  // No pipeline, no EOS message: the event comes to the pad.
  void wait_for_end() {
    while (GstEvent* event = gst_harness_pull_event(harness())) {
      const bool ended = GST_EVENT_TYPE(event) == GST_EVENT_EOS;
      gst_event_unref(event);
      if (ended) return;
    }
    ck_abort_msg("no EOS came");
  }
};

GST_START_TEST(a_recording_becomes_a_stream_of_its_own_times) {
  const std::vector<std::string> expected = {"0 000",   "100 000", "200 000", "250 100",
                                             "300 100", "400 111", "470 011"};
  for (int run = 0; run < 2; ++run) fail_unless(Source(kWalk).all() == expected);
  Source again(kWalk);
  fail_unless(again.all() == expected);
  gst_element_set_state(again.element(), GST_STATE_NULL);  // and once more from the beginning
  fail_unless_equals_int(gst_harness_events_in_queue(again.harness()), 0);
  fail_unless(again.all() == expected);
}
GST_END_TEST

bool seek(Source& source, double rate, GstClockTime start) {
  return gst_harness_push_upstream_event(
      source.harness(), gst_event_new_seek(rate, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH, GST_SEEK_TYPE_SET,
                                           static_cast<gint64>(start), GST_SEEK_TYPE_NONE, -1));
}

GST_START_TEST(a_recording_is_sought_in_and_a_live_source_is_not) {
  const std::string script = "heartbeat=3600000000000 script=\"0,0,0,0; 1,1,0,0; 2.5,0,1,0; 3,0,1,0\"";
  Source source(script);
  fail_unless(source.all() == std::vector<std::string>({"0 000", "1000 100", "2500 110", "2520 010"}));
  while (GstMessage* message = source.pop(GST_MESSAGE_ELEMENT)) gst_message_unref(message);
  fail_unless(seek(source, 1, 2 * GST_SECOND));
  fail_unless(source.all() == std::vector<std::string>({"2000 100", "2500 110", "2520 010"}));
  g_autoptr(GstEvent) event = gst_pad_get_sticky_event(source.harness()->sinkpad, GST_EVENT_SEGMENT, 0);
  const GstSegment* segment = nullptr;
  gst_event_parse_segment(event, &segment);
  fail_unless_equals_uint64(segment->start, 2 * GST_SECOND);
  fail_unless_equals_uint64(segment->time, 2 * GST_SECOND);
  for (const GstClockTime running : {0, 500, 520}) {  // ms
    g_autoptr(GstMessage) message = source.pop(GST_MESSAGE_ELEMENT);
    fail_unless(cerberus_message_is_pir(message));
    fail_unless_equals_uint64(running_time_of(message), running * GST_MSECOND);
  }
  Source live("is-live=true " + script);
  live.play();
  live.pull();
  fail_if(seek(live, 1, 2 * GST_SECOND));
}
GST_END_TEST

// Nothing is flushed for it: what flows on would have no segment.
GST_START_TEST(a_seek_backwards_is_refused_and_leaves_the_stream_as_it_is) {
  Source source(std::string("name=source ") + kWalk);
  source.play();
  source.pull();
  fail_if(seek(source, -1, GST_SECOND));
  fail_if(gst_element_seek(source.child("source"), -1, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                           GST_SEEK_TYPE_SET, 0, GST_SEEK_TYPE_SET, GST_SECOND));
  g_autoptr(GstEvent) segment = gst_pad_get_sticky_event(source.harness()->sinkpad, GST_EVENT_SEGMENT, 0);
  fail_unless(segment != nullptr, "the segment is gone");
  fail_unless_equals_int(source.all().size(), 6);
}
GST_END_TEST

// A seek in a recorded night returns the sensor states of that time.
GST_START_TEST(after_a_seek_frames_meet_the_readings_of_their_time) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "videotestsrc ! video/x-raw,format=GRAY8,width=16,height=16,framerate=25/1 ! pirfusion name=fusion "
      "max-wait=18446744073709551615 ! appsink name=sink sync=false max-buffers=2 "
      "pirsrc script=\"0,0,0,0; 1,1,0,0; 2.5,0,1,0; 60,0,1,0\" ! queue ! fusion.pir_0",
      nullptr);
  fail_unless(pipeline != nullptr);
  g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline), "sink");
  const auto next = [&] {
    g_autoptr(GstSample) sample = nullptr;
    g_signal_emit_by_name(sink, "pull-sample", &sample);
    GstBuffer* buffer = gst_sample_get_buffer(sample);
    const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
    return std::to_string(GST_BUFFER_PTS(buffer) / GST_MSECOND) + " " +
           digits(fusion->sensors, fusion->n_sensors);
  };
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  fail_unless(next() == "0 000");
  for (const int second : {2, 0, 30, 2}) {
    fail_unless(gst_element_seek_simple(
        pipeline, GST_FORMAT_TIME, static_cast<GstSeekFlags>(GST_SEEK_FLAG_FLUSH | GST_SEEK_FLAG_ACCURATE),
        second * GST_SECOND));
    for (int k = 0; k < 20; ++k) {
      const int time = second * 1000 + k * 40;
      const char* said = time < 1000 ? "000" : time < 2500 ? "100" : time < 2520 ? "110" : "010";
      const std::string read = next();
      fail_unless(read == std::to_string(time) + " " + said, "%s, not %s at %d", read.c_str(), said, time);
    }
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
}
GST_END_TEST

GST_START_TEST(caps_tell_where_the_sensors_look) {
  Source source("bearings=\"-90, 0, 90, 270\" field-of-view=100 script=\"0,0,0,0,1\"");
  source.play();
  fail_unless(source.pull().readings == "0001");
  GstCaps* caps = gst_pad_get_current_caps(source.harness()->sinkpad);
  CerberusPirInfo info;
  fail_unless(cerberus_pir_info_from_caps(&info, caps, nullptr));
  fail_unless_equals_int(info.format, CERBERUS_PIR_PRESENCE);
  fail_unless_equals_int(info.sensors, 4);
  const double bearings[] = {-90, 0, 90, -90};
  for (int i = 0; i < 4; ++i) fail_unless_equals_float(info.bearings[i], bearings[i]);
  fail_unless_equals_float(info.field_of_view, 100);
  gst_caps_unref(caps);
}
GST_END_TEST

GST_START_TEST(every_change_is_a_message_and_a_heartbeat_is_none) {
  Source source(kWalk);
  source.all();
  const struct {
    GstClockTime time;
    const char* readings;
  } expected[] = {{0, "000"}, {250, "100"}, {400, "111"}, {470, "011"}};
  for (const auto& one : expected) {
    GstMessage* message = source.pop(GST_MESSAGE_ELEMENT);
    fail_unless(message != nullptr);
    g_autoptr(CerberusPir) readings = cerberus_message_parse_pir(message);
    fail_unless(readings != nullptr);
    fail_unless_equals_uint64(running_time_of(message), one.time * GST_MSECOND);
    fail_unless(digits(readings->sensors, readings->n_sensors) == one.readings);
    fail_unless_equals_int(readings->doubtful, 0);
    gst_message_unref(message);
  }
  fail_unless(source.pop(GST_MESSAGE_ELEMENT) == nullptr);
}
GST_END_TEST

GST_START_TEST(the_model_follows_the_properties) {
  const struct {
    const char* properties;
    std::vector<std::string> expected;
  } cases[] = {
      {"active-low=true script=\"0,1;1,0;2,1\"", {"0 0", "1000 1", "2020 0"}},
      {"script=\"0,0;1,1;1.003,0;2,0\"", {"0 0", "1000 1", "1023 0"}},
      {"min-pulse=50000000 script=\"0,0;1,1;1.04,0;2,1;3,1\"", {"0 0", "2050 1"}},
      {"min-pulse=10000000 script=\"0,0;1,1;1.003,0;2,1;2.01,0;3,0\"", {"0 0", "2010 1", "2030 0"}},
      {"debounce=0 script=\"0,0;1,1;2,0\"", {"0 0", "1000 1", "2000 0"}},
      {"hold=3000000000 script=\"0,0;1,1;2,0;9,0\"", {"0 0", "1000 1", "4000 0"}},
      {"hold=3000000000 script=\"0,0;1,1;1.5,0;2,1;3,0;9,0\"", {"0 0", "1000 1", "5000 0"}},
      {"hold=3000000000 retrigger=false script=\"0,0;1,1;1.5,0;2,1;3,0;9,0\"", {"0 0", "1000 1", "4000 0"}},
      {"block-time=2000000000 script=\"0,0;1,1;2,0;3,1;3.5,0;9,0\"", {"0 0", "1000 1", "2020 0"}},
      {"warm-up=5000000000 script=\"0,0;1,1;9,1\"", {"0 2", "5000 1"}},
      {"stuck-after=5000000000 script=\"0,0;1,1;9,1\"", {"0 0", "1000 1", "6000 2"}},
      {"chatter-edges=2 chatter-window=1000000000 script=\"0,0;1,1;1.1,0;1.2,1;1.3,0;9,0\"",
       {"0 0", "1000 1", "1120 0", "1200 2", "2200 0"}},
      {"preset=sk-11 warm-up=0 script=\"0,1;1,0\"", {"0 0", "1000 1"}},
      {"preset=am312 script=\"0,0;40,1\"", {"0 2", "30000 0", "40000 1"}},
  };
  for (const auto& one : cases) {
    const std::string line = std::string("bearings=0 heartbeat=3600000000000 ") + one.properties;
    const std::vector<std::string> readings = Source(line).all();
    std::string text;
    for (const std::string& each : readings) text += each + "; ";
    fail_unless(readings == one.expected, "%s: %s", line.c_str(), text.c_str());
  }
}
GST_END_TEST

GST_START_TEST(a_property_that_was_set_wins_over_the_preset_in_any_order) {
  for (const char* line : {"pirsrc preset=sk-11 warm-up=7", "pirsrc warm-up=7 preset=sk-11"}) {
    GstElement* element = gst_parse_launch(line, nullptr);
    guint64 warm_up = 0;
    gboolean active_low = FALSE;
    gdouble fov = 0;
    g_object_get(element, "warm-up", &warm_up, "active-low", &active_low, "field-of-view", &fov, nullptr);
    fail_unless_equals_uint64(warm_up, 7);
    fail_unless(active_low);
    fail_unless_equals_float(fov, 120);
    gst_util_set_object_arg(G_OBJECT(element), "preset", "none");
    g_object_get(element, "warm-up", &warm_up, "active-low", &active_low, nullptr);
    fail_unless_equals_uint64(warm_up, 7);
    fail_unless(!active_low);
    gst_object_unref(element);
  }
}
GST_END_TEST

GST_START_TEST(the_caps_say_how_far_the_sensors_see_where_it_is_known) {
  // The range of the HC-SR501 is 7 m.
  for (const auto& [properties, metres] :
       {std::pair("", -1.), std::pair("preset=hc-sr501", 7.), std::pair("preset=hc-sr501 range=5", 5.),
        std::pair("range=5.5", 5.5)}) {
    Source source(std::string(properties) + " script=\"0,0,0,0\"");
    source.all();
    GstCaps* caps = gst_pad_get_current_caps(source.harness()->sinkpad);
    CerberusPirInfo info;
    fail_unless(cerberus_pir_info_from_caps(&info, caps, nullptr));
    gdouble range = -1;
    gst_structure_get_double(gst_caps_get_structure(caps, 0), "range", &range);
    fail_unless_equals_float(range, metres);
    gst_caps_unref(caps);
  }
}
GST_END_TEST

GST_START_TEST(a_sensor_that_is_stuck_or_chatters_is_named_and_so_is_its_recovery) {
  Source stuck(
      "bearings=0,-120,120 script=\"0,0,0,0; 1,0,1,0; 700,0,0,0; 701,0,0,0\" heartbeat=1000000000000");
  stuck.all();
  const std::string warning = stuck.warning();
  fail_unless(says(warning, "PIR sensor infer2 (reading 2 of script, bearing -120) is stuck on"));
  GstMessage* info = stuck.pop(static_cast<GstMessageType>(GST_MESSAGE_WARNING | GST_MESSAGE_INFO));
  fail_unless(info && GST_MESSAGE_TYPE(info) == GST_MESSAGE_INFO);  // not warned of twice
  GError* error = nullptr;
  gst_message_parse_info(info, &error, nullptr);
  fail_unless(says(error->message, "infer2") && says(error->message, "works again"));
  g_error_free(error);
  gst_message_unref(info);

  Source chattering(
      "chatter-edges=3 script=\"0,0,0,0; 1,0,0,1; 1.1,0,0,0; 1.2,0,0,1; 1.3,0,0,0; 1.4,0,0,1\"");
  chattering.all();
  fail_unless(says(chattering.warning(), "infer3 (reading 3 of script, bearing 120) is chattering"));
}
GST_END_TEST

GST_START_TEST(a_wrong_setting_is_an_error_that_names_it) {
  const GQuark resource = GST_RESOURCE_ERROR;
  const gint settings = GST_RESOURCE_ERROR_SETTINGS, not_found = GST_RESOURCE_ERROR_NOT_FOUND;
  fail_unless(says(Source("driver=radar").refusal(resource, settings),
                   "no PIR driver \"radar\". Drivers: evdev, external, gpio, iio, replay, scripted"));
  fail_unless(says(Source("bearings=\"\"").refusal(resource, settings), "1 to 16"));
  fail_unless(says(Source("bearings=0,north").refusal(resource, settings), "\"north\" is no direction"));
  fail_unless(says(Source("bearings=0,,1").refusal(resource, settings), "\"\" is no direction"));
  fail_unless(says(Source("bearings=nan").refusal(resource, settings), "\"nan\" is no direction"));
  fail_unless(says(Source("bearings=0,1,2,3,4,5,6,7,8,9,10,11,12,13,14,15,16").refusal(resource, settings),
                   "1 to 16"));
  fail_unless(says(Source("driver=replay").refusal(resource, settings), "name the file"));
  fail_unless(
      says(Source("driver=replay location=/nowhere.csv").refusal(resource, not_found), "/nowhere.csv"));
  fail_unless(
      says(Source("script=\"open fail the shed burnt down\"").refusal(resource, GST_RESOURCE_ERROR_READ),
           "the shed burnt down"));
  // Without hardware, and without the libraries: a clear word, and nothing hangs.
  for (const char* line : {"driver=gpio chip=/dev/attic lines=0,1,2", "driver=iio iio-device=attic"}) {
    Source source(line);
    gst_element_set_state(source.element(), GST_STATE_PAUSED);
    GstMessage* message = source.wait_for(GST_MESSAGE_ERROR);
    GError* error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    fail_unless(g_error_matches(error, resource, settings) ? says(error->message, "build again")
                                                           : says(error->message, "attic"));
    g_error_free(error);
    gst_message_unref(message);
  }
}
GST_END_TEST

GST_START_TEST(a_bad_recording_is_named_with_its_line) {
  gchar* path = nullptr;
  const gint file = g_file_open_tmp("cerberus-pir-XXXXXX", &path, nullptr);
  g_close(file, nullptr);
  const std::string properties = std::string("driver=replay location=") + path;
  for (const char* text : {"0,0,0,0\n1,1,0", "0,0,0,0\n\n5,1,0,0\n4,0,0,0\n"}) {
    g_file_set_contents(path, text, -1, nullptr);
    const std::string why = Source(properties).refusal(GST_STREAM_ERROR, GST_STREAM_ERROR_DECODE);
    fail_unless(says(why, path) && says(why, text[10] == '1' ? "line 2" : "line 4"));
  }
  // Whatever bytes it has, a message is UTF-8 (else GStreamer itself complains) and does not end at a NUL.
  using namespace std::string_literals;
  for (const auto& [text, expected] :
       {std::pair("0,0,0,0\n\xff\xfe,1,0,0\n"s, "\"\\xff\\xfe\" is no time"),
        {"0,0,0,0\n\0\0,1,0,0\n"s, "\"\\x00\\x00\" is no time"},
        {"0,0,0,0\n1,\u00e9\x1b,0,0\n"s, "\"\u00e9\\x1b\" is no reading"},
        {"0,0,0,0\n{\"time\":1,\"pir\":[\"\xc3\"]}"s, "no complete JSON object"}}) {
    g_file_set_contents(path, text.data(), static_cast<gssize>(text.size()), nullptr);
    const std::string why = Source(properties).refusal(GST_STREAM_ERROR, GST_STREAM_ERROR_DECODE);
    fail_unless(says(why, "line 2: ") && says(why, expected), "%s", why.c_str());
  }
  Source nowhere("name=source driver=replay");
  g_object_set(nowhere.child("source"), "location", "/nowhere\xff.csv", nullptr);
  fail_unless(says(nowhere.refusal(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND), "/nowhere\\xff.csv"));
  g_file_set_contents(path, "{\"pts\":0,\"pir\":[0,0,0]}\n{\"pts\":50000000,\"pir\":[0,0,1]}\n", -1, nullptr);
  fail_unless(Source(properties).all() == std::vector<std::string>({"0 000", "50 001"}));
  g_unlink(path);
  g_free(path);
}
GST_END_TEST

GST_START_TEST(a_driver_that_fails_ends_the_stream_with_its_words) {
  Source source("script=\"0,0,0,0; 0.15 fail the cable broke\"");
  source.play();
  fail_unless(says(source.error(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ), "the cable broke"));
  for (const auto& [time, readings] : {std::pair{0, "000"}, {100, "000"}, {150, "222"}}) {
    const Buffer buffer = source.pull();
    fail_unless_equals_uint64(buffer.pts, time * GST_MSECOND);
    ck_assert_str_eq(buffer.readings.c_str(), readings);  // nothing is known of a sensor that cannot be read
  }
  Source leds("script=\"0,0,0,0; show fail no light\"");
  leds.play();
  fail_unless(says(leds.error(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ), "no light"));
}
GST_END_TEST

GST_START_TEST(a_failure_that_recurs_after_a_seek_is_reported_again) {
  Source source("script=\"0,0,0,0; 0.15 fail the cable broke\"");
  source.play();
  for (int round = 0; round < 3; ++round) {
    fail_unless(says(source.error(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ), "the cable broke"));
    fail_unless(source.pop(GST_MESSAGE_ERROR) == nullptr, "one message a failure");
    fail_unless(seek(source, 1, 0));
  }
}
GST_END_TEST

// The head must not search for a person whom no sensor detects any more.
GST_START_TEST(the_last_reading_of_failed_sensors_is_not_kept) {
  Source source("heartbeat=1000000000 script=\"0,0,0,0; 0.5,0,1,0; 1.5 fail the cable broke\"");
  source.play();
  source.error(GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ);
  rig::Rig fusion(false);
  GstHarness* pir = fusion.add_pir(rig::kPaper, "pir_%u", false);
  for (int i = 0; i < 4; ++i) fail_unless_equals_int(gst_harness_push(pir, source.take()), GST_FLOW_OK);
  gst_harness_push_event(pir, gst_event_new_eos());
  rig::assert_says(rig::text(rig::sensors(fusion.at(1499 * rig::kMs))), "010");
  rig::assert_says(rig::text(rig::sensors(fusion.at(1500 * rig::kMs))), "222");
  rig::assert_says(rig::text(rig::sensors(fusion.at(60 * GST_SECOND))), "222");
}
GST_END_TEST

GST_START_TEST(live_it_keeps_the_clocks_time) {
  Source source(std::string("is-live=true ") + kWalk);
  source.play();
  Buffer buffer = source.pull();  // at once
  fail_unless_equals_uint64(buffer.pts, 0);
  ck_assert_str_eq(buffer.readings.c_str(), "000");
  fail_unless(gst_harness_try_pull(source.harness()) == nullptr);
  const std::pair<GstClockTime, const char*> expected[] = {{100, "000"}, {200, "000"}, {250, "100"}};
  for (const auto& [time, readings] : expected) {
    gst_harness_set_time(source.harness(), time * GST_MSECOND);
    buffer = source.pull();
    fail_unless_equals_uint64(buffer.pts, time * GST_MSECOND);
    ck_assert_str_eq(buffer.readings.c_str(), readings);
  }
  GstQuery* query = gst_query_new_latency();
  fail_unless(gst_pad_peer_query(source.harness()->sinkpad, query));
  gboolean live = FALSE;
  GstClockTime least = 1, most = 1;
  gst_query_parse_latency(query, &live, &least, &most);
  fail_unless(live);
  fail_unless_equals_uint64(least, 0);
  fail_unless_equals_uint64(most, GST_CLOCK_TIME_NONE);
  gst_query_unref(query);
}
GST_END_TEST

GST_START_TEST(stopping_takes_no_time_while_it_waits) {
  Source source("is-live=true heartbeat=3600000000000 script=\"0,0,0,0; 3600,1,0,0\"");
  for (const GstState down : {GST_STATE_PAUSED, GST_STATE_READY, GST_STATE_NULL})
    assert_prompt(gst_element_state_get_name(down), [&] {
      source.play();
      source.pull();
      const auto took = time_taken([&] { gst_element_set_state(source.element(), down); });
      gst_element_set_state(source.element(), GST_STATE_NULL);
      return took;
    });
}
GST_END_TEST

GST_START_TEST(while_the_base_turns_a_detection_is_doubtful) {
  Source source("is-live=true heartbeat=3600000000000 script=\"0,0,0,0; 1,0,1,0; 3600,0,1,0\"");
  source.play();
  fail_unless(source.pull().readings == "000");
  fail_unless(gst_harness_push_upstream_event(source.harness(), base_event(-20, 0)));
  gst_harness_set_time(source.harness(), GST_SECOND);
  gst_harness_push_upstream_event(source.harness(), base_event(-20, GST_SECOND));  // wakes it
  fail_unless(source.pull().readings == "010");
  guint doubtful = 0;
  for (int i = 0; i < 2; ++i) {
    GstMessage* message = source.wait_for(GST_MESSAGE_ELEMENT);
    gst_structure_get_uint(gst_message_get_structure(message), "doubtful", &doubtful);
    gst_message_unref(message);
  }
  fail_unless_equals_int(doubtful, 2);
  // Another element's event is not for this source, and does no harm.
  gst_harness_push_upstream_event(
      source.harness(),
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                           gst_structure_new("cerberus-base", "yaw-rate", G_TYPE_STRING, "x", nullptr)));
}
GST_END_TEST

// Both sensors look aside at most: past things 2 m away .3 m/s are 8.6 degrees a second for one to the side, 4.3 for one
// of 60 degrees ahead. A turn that is reported by an event of its own does not hide the speed.
GST_START_TEST(while_the_base_drives_a_sensor_to_the_side_is_doubtful) {
  Source source(
      "bearings=0,90 field-of-view=60 is-live=true heartbeat=3600000000000 "
      "script=\"0,0,0; 1,1,1; 3600,1,1\"");
  source.play();
  fail_unless(source.pull().readings == "00");
  gst_harness_set_time(source.harness(), 990 * GST_MSECOND);
  fail_unless(gst_harness_push_upstream_event(source.harness(), drive_event(.3, 990 * GST_MSECOND)));
  fail_unless(gst_harness_push_upstream_event(source.harness(), base_event(0, 990 * GST_MSECOND)));
  gst_harness_set_time(source.harness(), 1100 * GST_MSECOND);
  gst_harness_push_upstream_event(source.harness(), base_event(0, 1100 * GST_MSECOND));  // wakes it
  fail_unless(source.pull().readings == "11");
  guint doubtful = 0;
  for (int i = 0; i < 2; ++i) {
    GstMessage* message = source.wait_for(GST_MESSAGE_ELEMENT);
    gst_structure_get_uint(gst_message_get_structure(message), "doubtful", &doubtful);
    gst_message_unref(message);
  }
  fail_unless_equals_int(doubtful, 0b10);
}
GST_END_TEST

GST_START_TEST(two_of_them_know_nothing_of_each_other) {
  Source one(kWalk), two("bearings=0,180 script=\"0,1,1\"");
  fail_unless(two.all() == std::vector<std::string>({"0 11"}));
  fail_unless_equals_int(one.all().size(), 7);
}
GST_END_TEST

Suite* pirsrc_suite() {
  watch_library_log();
  Suite* suite = suite_create("pirsrc");
  TCase* tests = tcase_create("pirsrc");
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_recording_becomes_a_stream_of_its_own_times);
  tcase_add_test(tests, a_recording_is_sought_in_and_a_live_source_is_not);
  tcase_add_test(tests, a_seek_backwards_is_refused_and_leaves_the_stream_as_it_is);
  tcase_add_test(tests, after_a_seek_frames_meet_the_readings_of_their_time);
  tcase_add_test(tests, caps_tell_where_the_sensors_look);
  tcase_add_test(tests, every_change_is_a_message_and_a_heartbeat_is_none);
  tcase_add_test(tests, the_model_follows_the_properties);
  tcase_add_test(tests, a_property_that_was_set_wins_over_the_preset_in_any_order);
  tcase_add_test(tests, the_caps_say_how_far_the_sensors_see_where_it_is_known);
  tcase_add_test(tests, a_sensor_that_is_stuck_or_chatters_is_named_and_so_is_its_recovery);
  tcase_add_test(tests, a_wrong_setting_is_an_error_that_names_it);
  tcase_add_test(tests, a_bad_recording_is_named_with_its_line);
  tcase_add_test(tests, a_driver_that_fails_ends_the_stream_with_its_words);
  tcase_add_test(tests, a_failure_that_recurs_after_a_seek_is_reported_again);
  tcase_add_test(tests, the_last_reading_of_failed_sensors_is_not_kept);
  tcase_add_test(tests, live_it_keeps_the_clocks_time);
  tcase_add_test(tests, stopping_takes_no_time_while_it_waits);
  tcase_add_test(tests, while_the_base_turns_a_detection_is_doubtful);
  tcase_add_test(tests, while_the_base_drives_a_sensor_to_the_side_is_doubtful);
  tcase_add_test(tests, two_of_them_know_nothing_of_each_other);
  suite_add_tcase(suite, tests);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(pirsrc)
