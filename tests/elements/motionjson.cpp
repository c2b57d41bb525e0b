// SPDX-License-Identifier: LGPL-2.1-or-later
// Expected lines are written by hand after the format's description, number by number.
#include <cmath>
#include <limits>

#include "records.h"

#include "../support/german.h"
#include "outputs.h"

using namespace outputs;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
const std::string kCaps = caps_string("I420", 64, 48);

std::string pull_line(GstHarness* h) {
  GstBuffer* buffer = gst_harness_pull(h);
  const auto all = bytes(buffer);
  gst_buffer_unref(buffer);
  return {all.begin(), all.end()};
}

std::string line_of(GstHarness* h, GstBuffer* frame) {
  fail_unless_equals_int(gst_harness_push(h, frame), GST_FLOW_OK);
  fail_unless_equals_int(gst_harness_buffers_in_queue(h), 1);
  return pull_line(h);
}

// Not live: a line of a live stream carries the clock's time.
Harness lines() {
  Harness h = harness("motionjson");
  gst_harness_set_live(h.get(), FALSE);
  return h;
}

Harness started(const std::string& caps = kCaps) {
  Harness h = lines();
  gst_harness_set_src_caps_str(h.get(), caps.c_str());
  return h;
}

// A frame that carries one of everything.
GstBuffer* full_frame() {
  GstBuffer* buffer = frame(info_of(kCaps), 3);
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.matrix[0] = 0.99999874512;
  motion.matrix[1] = -0.25;
  motion.matrix[2] = -3.5;
  motion.matrix[6] = 1.25e-7;
  motion.confidence = 0.87149;
  cerberus_buffer_set_camera_motion(buffer, &motion);
  cerberus::plugin::ThresholdFacts facts;
  facts.result = {14, 14, 1, true};
  cerberus::plugin::set_threshold_facts(buffer, facts);
  CerberusRegion first = region(4, 10, 20, 12, 18);
  first.vx = -31.204999;
  first.vy = 0.4;
  first.confidence = 0.9306;
  first.bearing = -12.25;
  first.distance = 4.5;
  add(buffer, first);
  CerberusRegion second = region(5, 0, 0, 8, 9);
  second.state = CERBERUS_REGION_STOPPED;
  second.person = TRUE;
  second.kind = CERBERUS_REGION_KIND_GROUP;
  second.vx = kNaN;
  second.vy = -kInfinity;
  second.confidence = 1;
  add(buffer, second);
  CerberusRegion third = region(6, 30, 30, 5, 5);
  third.state = CERBERUS_REGION_COASTED;
  third.tracked = third.motion = FALSE;
  add(buffer, third);
  return buffer;
}

const char* const kFullLine =
    R"({"pts":120000000,"frame":0,"width":64,"height":48,"threshold":14,)"
    R"("camera":[0.999998745,-0.25,-3.5,0,1,0,1.25e-07,0,1],"confidence":0.871,"objects":[)"
    R"({"id":4,"type":"motion","kind":"person-like","state":"seen","x":10,"y":20,"w":12,"h":18,"vx":-31.2,"vy":0.4,"confidence":0.931,)"
    R"("bearing":-12.25,"distance":4.5,"witnesses":["motion"]},)"
    R"({"id":5,"type":"person","kind":"group","state":"stopped","x":0,"y":0,"w":8,"h":9,"vx":null,"vy":null,"confidence":1,)"
    R"("bearing":null,"distance":null,"witnesses":["motion","person"]},)"
    R"({"id":null,"type":"motion","kind":"person-like","state":"coasted","x":30,"y":30,"w":5,"h":5,"vx":0,"vy":0,"confidence":0.5,)"
    R"("bearing":null,"distance":null,"witnesses":[]}]})"
    "\n";

std::string empty_line(const char* pts, int number, int width = 64, int height = 48) {
  return std::string(R"({"pts":)") + pts + R"(,"frame":)" + std::to_string(number) + R"(,"width":)" +
         std::to_string(width) + R"(,"height":)" + std::to_string(height) +
         R"(,"threshold":null,"camera":null,"confidence":null,"objects":null})" + "\n";
}

}  // namespace

GST_START_TEST(a_frame_without_metas_gives_a_line_of_unknowns) {
  Harness h = started();
  expect(line_of(h.get(), frame(info_of(kCaps))), empty_line("0", 0));
}
GST_END_TEST

GST_START_TEST(everything_attached_is_on_the_line) {
  Harness h = started();
  expect(line_of(h.get(), full_frame()), kFullLine);
}
GST_END_TEST

GST_START_TEST(pose_sensors_and_decision_are_there_where_the_frame_carries_them) {
  Harness h = started();
  GstBuffer* buffer = frame(info_of(kCaps));
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.pan = -12.346, pose.tilt = 3;
  pose.moving = TRUE;
  cerberus_buffer_set_pose(buffer, &pose);
  std::string line = empty_line("0", 0);
  line.resize(line.rfind('}'));
  expect(line_of(h.get(), buffer), line + R"(,"pose":{"pan":-12.35,"tilt":3,"moving":true}})" + "\n");

  buffer = frame(info_of(kCaps), 1);
  CerberusFusion fusion;
  cerberus_fusion_init(&fusion);
  fusion.rule = 3;
  fusion.rule_name = "the \"gate\"";
  fusion.action = CERBERUS_FUSION_TURN_LEFT;
  fusion.n_sensors = 3;
  fusion.sensors[1] = 1, fusion.sensors[2] = 2;
  cerberus_buffer_set_fusion(buffer, &fusion);
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = -12.504;
  cerberus_buffer_set_base(buffer, &base);
  line = empty_line("40000000", 1);
  line.resize(line.rfind('}'));
  line += R"(,"base":{"yaw-rate":-12.5},"pir":[0,1,2])";
  line += R"(,"fusion":{"rule":3,"name":"the \"gate\"","action":"turn-left","target":null}})";
  expect(line_of(h.get(), buffer), line + "\n");
}
GST_END_TEST

GST_START_TEST(a_locale_with_a_decimal_comma_changes_nothing) {
  const cerberus::tests::German german;
  if (!german) return;
  Harness h = started();
  expect(line_of(h.get(), full_frame()), kFullLine);
}
GST_END_TEST

// "Nothing was found" and "no detector ran" must be different values in the lines.
GST_START_TEST(nothing_found_is_not_no_detector) {
  Harness h = started();
  GstBuffer* buffer = frame(info_of(kCaps));
  g_autoptr(GPtrArray) none = g_ptr_array_new();
  fail_unless(cerberus_buffer_set_regions(buffer, none));
  std::string line = empty_line("0", 0);
  line.replace(line.find(R"("objects":null)"), 14, R"("objects":[])");
  expect(line_of(h.get(), buffer), line);
}
GST_END_TEST

GST_START_TEST(a_threshold_that_is_not_ready_is_none) {
  Harness h = started();
  GstBuffer* buffer = frame(info_of(kCaps));
  cerberus::plugin::ThresholdFacts facts;
  facts.result.threshold = 14;
  cerberus::plugin::set_threshold_facts(buffer, facts);
  expect(line_of(h.get(), buffer), empty_line("0", 0));
}
GST_END_TEST

GST_START_TEST(a_frame_without_a_time_has_a_null_pts) {
  Harness h = started();
  GstBuffer* buffer = frame(info_of(kCaps));
  GST_BUFFER_PTS(buffer) = GST_BUFFER_DURATION(buffer) = GST_CLOCK_TIME_NONE;
  fail_unless_equals_int(gst_harness_push(h.get(), buffer), GST_FLOW_OK);
  GstBuffer* line = gst_harness_pull(h.get());
  fail_if(GST_BUFFER_PTS_IS_VALID(line));
  const auto all = bytes(line);
  expect(std::string(all.begin(), all.end()), empty_line("null", 0));
  gst_buffer_unref(line);
}
GST_END_TEST

GST_START_TEST(a_line_has_the_time_of_its_frame) {
  Harness h = started();
  fail_unless_equals_int(gst_harness_push(h.get(), frame(info_of(kCaps), 7)), GST_FLOW_OK);
  GstBuffer* line = gst_harness_pull(h.get());
  fail_unless_equals_uint64(GST_BUFFER_PTS(line), 280 * GST_MSECOND);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(line), 40 * GST_MSECOND);
  gst_buffer_unref(line);
}
GST_END_TEST

GST_START_TEST(numbers_that_are_not_finite_are_null) {
  Harness h = started();
  GstBuffer* buffer = frame(info_of(kCaps));
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.matrix[0] = kNaN;
  motion.matrix[5] = kInfinity;
  motion.matrix[1] = -0.0;
  motion.matrix[2] = 1e300;
  motion.confidence = kNaN;
  cerberus_buffer_set_camera_motion(buffer, &motion);
  const std::string line = line_of(h.get(), buffer);
  fail_unless(line.find(R"("camera":[null,0,1e+300,0,1,null,0,0,1],"confidence":null,)") != std::string::npos,
              "%s", line.c_str());
}
GST_END_TEST

GST_START_TEST(every_buffer_has_exactly_one_line_also_across_a_flush) {
  Harness h = started();
  for (int k = 0; k < 100; ++k) {
    if (k == 50) push_flush(h.get());
    const std::string pts = std::to_string(k * 40000000LL);
    expect(line_of(h.get(), frame(info_of(kCaps), k)), empty_line(pts.c_str(), k));
  }
  fail_unless(gst_harness_push_event(h.get(), gst_event_new_eos()));
  fail_unless(event_came(h.get(), GST_EVENT_EOS));
  fail_unless_equals_int(gst_harness_buffers_in_queue(h.get()), 0);
}
GST_END_TEST

GST_START_TEST(a_buffer_has_its_frames_number_and_times) {
  Harness h = started();
  for (guint64 k = 0; k < 3; ++k) {
    GstBuffer* in = frame(info_of(kCaps), static_cast<int>(k));
    GST_BUFFER_DURATION(in) = 7;
    fail_unless_equals_int(gst_harness_push(h.get(), in), GST_FLOW_OK);
    g_autoptr(GstBuffer) out = gst_harness_pull(h.get());
    fail_unless_equals_uint64(GST_BUFFER_OFFSET(out), k);
    fail_unless_equals_uint64(GST_BUFFER_OFFSET_END(out), k + 1);
    fail_unless_equals_uint64(GST_BUFFER_PTS(out), k * 40 * GST_MSECOND);
    fail_unless_equals_uint64(GST_BUFFER_DURATION(out), 7);
  }
}
GST_END_TEST

GST_START_TEST(an_empty_buffer_has_a_line_too) {
  Harness h = started();
  GstBuffer* empty = gst_buffer_new();
  GST_BUFFER_PTS(empty) = 0;
  expect(line_of(h.get(), empty), empty_line("0", 0));
}
GST_END_TEST

GST_START_TEST(frames_count_from_0_after_every_start) {
  Harness h = started();
  line_of(h.get(), frame(info_of(kCaps)));
  gst_element_set_state(h->element, GST_STATE_NULL);
  gst_element_set_state(h->element, GST_STATE_PLAYING);
  gst_harness_push_event(h.get(), gst_event_new_stream_start("again"));
  gst_harness_set_src_caps_str(h.get(), kCaps.c_str());
  push_segment(h.get());
  expect(line_of(h.get(), frame(info_of(kCaps))), empty_line("0", 0));
}
GST_END_TEST

GST_START_TEST(a_new_frame_size_is_on_the_next_line) {
  Harness h = started();
  line_of(h.get(), frame(info_of(kCaps)));
  const std::string odd = caps_string("NV12", 33, 35);
  gst_harness_set_src_caps_str(h.get(), odd.c_str());
  expect(line_of(h.get(), frame(info_of(odd), 1)), empty_line("40000000", 1, 33, 35));
}
GST_END_TEST

GST_START_TEST(every_raw_video_is_taken) {
  for (const char* format : kFormats) {
    const std::string caps = caps_string(format, 33, 35);
    Harness h = started(caps);
    expect(line_of(h.get(), frame(info_of(caps))), empty_line("0", 0, 33, 35));
  }
  for (const char* caps :
       {"video/x-raw(memory:DMABuf),format=NV12,width=64,height=48,framerate=25/1",
        "video/x-raw(memory:DMABuf),format=DMA_DRM,drm-format=NV12:0x0100000000000002,width=64,height=48",
        "video/x-raw,format=P010_10LE,width=64,height=48",
        "video/x-raw,format=I420,width=64,height=48,framerate=0/1",
        "video/x-raw,format=I420,width=64,height=48,framerate=25/1,interlace-mode=interleaved"}) {
    Harness h = started(caps);
    expect(line_of(h.get(), frame(info_of(kCaps))), empty_line("0", 0));
  }
}
GST_END_TEST

GST_START_TEST(the_output_is_json_lines) {
  Harness h = started();
  line_of(h.get(), frame(info_of(kCaps)));
  GstCaps* caps = gst_pad_get_current_caps(h->sinkpad);
  GstCaps* expected = gst_caps_from_string("application/x-json-lines");
  fail_unless(gst_caps_is_equal(caps, expected));
  gst_caps_unref(caps);
  gst_caps_unref(expected);
}
GST_END_TEST

GST_START_TEST(thousands_of_objects_fit_on_a_line) {
  Harness h = started();
  GstBuffer* buffer = frame(info_of(kCaps));
  for (guint id = 1; id <= 3000; ++id)
    add(buffer, region(id == 3000 ? G_MAXUINT32 : id, id % 60, id % 40, 3, 4));
  const std::string line = line_of(h.get(), buffer);
  std::size_t objects = 0;
  for (std::size_t at = line.find("{\"id\":"); at != std::string::npos; at = line.find("{\"id\":", at + 1))
    ++objects;
  fail_unless_equals_uint64(objects, 3000);
  fail_unless(line.find("{\"id\":4294967295,") != std::string::npos);
  fail_unless(line.ends_with("]}\n"));
}
GST_END_TEST

GST_START_TEST(two_instances_count_for_themselves) {
  Harness a = started(), b = started();
  line_of(a.get(), frame(info_of(kCaps)));
  expect(line_of(a.get(), frame(info_of(kCaps), 1)), empty_line("40000000", 1));
  expect(line_of(b.get(), frame(info_of(kCaps), 1)), empty_line("40000000", 0));
}
GST_END_TEST

GST_START_TEST(gaps_pass_and_nothing_is_delayed) {
  Harness h = started();
  line_of(h.get(), frame(info_of(kCaps)));
  event_came(h.get(), GST_EVENT_GAP);
  fail_unless(gst_harness_push_event(h.get(), gst_event_new_gap(40 * GST_MSECOND, 40 * GST_MSECOND)));
  fail_unless(event_came(h.get(), GST_EVENT_GAP));
  fail_unless_equals_int(gst_harness_buffers_in_queue(h.get()), 0);
  gst_harness_set_live(h.get(), TRUE);
  gst_harness_set_upstream_latency(h.get(), 5 * GST_MSECOND);
  fail_unless_equals_uint64(gst_harness_query_latency(h.get()), 5 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(upstream_may_use_any_stride) {
  Harness h = started();
  GstCaps* caps = gst_caps_from_string(kCaps.c_str());
  GstQuery* query = gst_query_new_allocation(caps, TRUE);
  fail_unless(gst_pad_peer_query(h->srcpad, query));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  gst_query_unref(query);
  gst_caps_unref(caps);
}
GST_END_TEST

static Suite* motionjson_suite() {
  watch_library_log();
  Suite* s = suite_create("motionjson");
  TCase* tc = tcase_create("lines");
  tcase_set_timeout(tc, 120);  // with GStreamer 1.24 and newer a region's cost grows with how many there are
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_frame_without_metas_gives_a_line_of_unknowns);
  tcase_add_test(tc, everything_attached_is_on_the_line);
  tcase_add_test(tc, pose_sensors_and_decision_are_there_where_the_frame_carries_them);
  tcase_add_test(tc, a_locale_with_a_decimal_comma_changes_nothing);
  tcase_add_test(tc, a_threshold_that_is_not_ready_is_none);
  tcase_add_test(tc, nothing_found_is_not_no_detector);
  tcase_add_test(tc, a_frame_without_a_time_has_a_null_pts);
  tcase_add_test(tc, a_line_has_the_time_of_its_frame);
  tcase_add_test(tc, numbers_that_are_not_finite_are_null);
  tcase_add_test(tc, thousands_of_objects_fit_on_a_line);
  tc = tcase_create("stream");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, every_buffer_has_exactly_one_line_also_across_a_flush);
  tcase_add_test(tc, a_buffer_has_its_frames_number_and_times);
  tcase_add_test(tc, an_empty_buffer_has_a_line_too);
  tcase_add_test(tc, frames_count_from_0_after_every_start);
  tcase_add_test(tc, a_new_frame_size_is_on_the_next_line);
  tcase_add_test(tc, every_raw_video_is_taken);
  tcase_add_test(tc, the_output_is_json_lines);
  tcase_add_test(tc, two_instances_count_for_themselves);
  tcase_add_test(tc, gaps_pass_and_nothing_is_delayed);
  tcase_add_test(tc, upstream_may_use_any_stride);
  return s;
}

GST_CHECK_MAIN(motionjson)
