// SPDX-License-Identifier: LGPL-2.1-or-later
// Wall-clock time and the camera's name in messages and JSON lines.
#include <cerberus/cerberus.h>

#include "outputs.h"
#include "support.h"

using namespace outputs;

namespace {

constexpr GstClockTime k2023 = G_GUINT64_CONSTANT(1700000000123456789);  // 2023-11-14 22:13:20 UTC
constexpr GstClockTime kFrom1900 = G_GUINT64_CONSTANT(2208988800) * GST_SECOND;
const std::string kCaps = caps_string("GRAY8", 64, 48);

GstBuffer* frame_with(const char* reference, GstClockTime time) {
  GstBuffer* buffer = frame(info_of(kCaps), 3);
  g_autoptr(GstCaps) caps = gst_caps_from_string(reference);
  gst_buffer_add_reference_timestamp_meta(buffer, caps, time, GST_CLOCK_TIME_NONE);
  return buffer;
}

Harness started(const char* line, bool live = false) {
  Harness h(gst_harness_new_parse(line));
  gst_harness_set_live(h.get(), live);
  gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
  return h;
}

std::string line_of(Harness& h, GstBuffer* buffer) {
  fail_unless_equals_int(gst_harness_push(h.get(), buffer), GST_FLOW_OK);
  GstBuffer* out = gst_harness_pull(h.get());
  const auto all = bytes(out);
  gst_buffer_unref(out);
  return {all.begin(), all.end()};
}

bool says(const std::string& line, const char* what) {
  return line.find(what) != std::string::npos;
}

}  // namespace

START_TEST(a_reference_timestamp_is_the_frames_wall_clock_time) {
  for (const auto& [reference, time] :
       {std::pair{"timestamp/x-unix", k2023}, {"timestamp/x-ntp", k2023 + kFrom1900}})
    for (const bool live : {true, false}) {
      Harness h = started("motionjson", live);
      const std::string line = line_of(h, frame_with(reference, time));
      fail_unless(
          says(line, R"("frame":0,"utc":"2023-11-14T22:13:20.123456Z","utc-source":"reference-timestamp",)"),
          "%s", line.c_str());
    }
}
END_TEST

START_TEST(other_references_and_ntp_times_before_1970_are_no_wall_clock_time) {
  Harness h = started("motionjson");
  fail_if(says(line_of(h, frame_with("timestamp/x-camera", k2023)), "utc"));
  fail_if(says(line_of(h, frame_with("timestamp/x-ntp", kFrom1900 - 1)), "utc"));
}
END_TEST

START_TEST(the_clock_counts_in_live_streams_only) {
  Harness file = started("motionjson");
  fail_if(says(line_of(file, frame(info_of(kCaps), 3)), "utc"));
  Harness live = started("motionjson", true);
  g_autoptr(GDateTime) before = g_date_time_new_now_utc();
  const std::string line = line_of(live, frame(info_of(kCaps), 3));
  g_autoptr(GDateTime) after = g_date_time_new_now_utc();
  fail_unless(says(line, R"("utc-source":"clock")"));
  const std::size_t at = line.find(R"("utc":")") + 7;
  g_autoptr(GDateTime) when = g_date_time_new_from_iso8601(line.substr(at, 27).c_str(), nullptr);
  fail_unless(when && g_date_time_compare(before, when) <= 0 && g_date_time_compare(when, after) <= 0, "%s",
              line.c_str());
}
END_TEST

START_TEST(a_name_travels_with_the_frame_and_a_nearer_one_has_priority) {
  Harness far = started("pirfusion camera-name=yard ! motionjson");
  fail_unless(says(line_of(far, frame(info_of(kCaps), 3)), R"("camera-name":"yard")"));
  Harness near = started("pirfusion camera-name=yard ! motionjson camera-name=\"the \\\"gate\\\"\"");
  fail_unless(says(line_of(near, frame(info_of(kCaps), 3)), R"("camera-name":"the \"gate\"")"));
  Harness none = started("pirfusion ! motionjson");
  fail_if(says(line_of(none, frame(info_of(kCaps), 3)), "camera-name"));
}
END_TEST

START_TEST(a_message_says_when_and_by_which_camera) {
  Harness h = started("pirfusion camera-name=yard");
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(h.get()->element, bus);
  fail_unless_equals_int(gst_harness_push(h.get(), frame_with("timestamp/x-unix", k2023)), GST_FLOW_OK);
  g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT);
  fail_unless(message && cerberus_message_is_fusion(message));
  g_autoptr(CerberusStamp) stamp = cerberus_message_parse_stamp(message);
  fail_unless_equals_string(stamp->camera_name, "yard");
  fail_unless_equals_uint64(stamp->utc, k2023);
  fail_unless_equals_int(stamp->utc_source, CERBERUS_UTC_REFERENCE_TIMESTAMP);
  GstBuffer* out = gst_harness_pull(h.get());
  const CerberusStamp* carried = cerberus_buffer_peek_stamp(out);
  fail_unless(carried && carried->utc == k2023 && g_str_equal(carried->camera_name, "yard"));
  fail_unless_equals_uint64(carried->running_time, stamp->running_time);
  gst_buffer_unref(out);
  gst_element_set_bus(h.get()->element, nullptr);
}
END_TEST

static Suite* stamps_suite() {
  watch_library_log();
  Suite* s = suite_create("stamps");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_reference_timestamp_is_the_frames_wall_clock_time);
  tcase_add_test(tc, other_references_and_ntp_times_before_1970_are_no_wall_clock_time);
  tcase_add_test(tc, the_clock_counts_in_live_streams_only);
  tcase_add_test(tc, a_name_travels_with_the_frame_and_a_nearer_one_has_priority);
  tcase_add_test(tc, a_message_says_when_and_by_which_camera);
  return s;
}

GST_CHECK_MAIN(stamps);
