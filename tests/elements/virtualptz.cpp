// SPDX-License-Identifier: LGPL-2.1-or-later
// A picture of 320 x 240 that sees 60 degrees has F = 160 / tan 30 = 277.128; a window of 160 x 120 rests at (80, 60) and
// reaches atan(80 / F) = 16.102 degrees to each side and atan(60 / F) = 12.216 up and down. A pan of atan(40 / F) =
// 8.2132 degrees moves it by 40 pixels.
#include <chrono>
#include <cmath>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "outputs.h"
#include "promises.h"

using namespace outputs;

namespace {

constexpr int kWidth = 320, kHeight = 240, kWindowWidth = 160, kWindowHeight = 120;
constexpr double kForty = 8.2132107;  // degrees
const std::string kLine = "virtualptz width=160 height=120 ";

struct Picture {
  GstVideoInfo info;
  GstBuffer* buffer;
  GstVideoFrame frame;
  Picture(const GstVideoInfo& i, GstBuffer* b) : info(i), buffer(b) {
    fail_unless(gst_video_frame_map(&frame, &info, buffer, GST_MAP_READ));
  }
  ~Picture() {
    gst_video_frame_unmap(&frame);
    gst_buffer_unref(buffer);
  }
  Picture(const Picture&) = delete;
  guint8 at(guint component, int x, int y) const {
    return static_cast<guint8*>(
        GST_VIDEO_FRAME_COMP_DATA(&frame, component))[y * GST_VIDEO_FRAME_COMP_STRIDE(&frame, component) +
                                                      x * GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, component)];
  }
  bool operator==(const Picture& other) const { return bytes(buffer) == bytes(other.buffer); }
};

GstBuffer* noise(const GstVideoInfo& info, int number) {
  GstBuffer* buffer = frame(info, number);
  GstMapInfo map;
  gst_buffer_map(buffer, &map, GST_MAP_WRITE);
  guint32 state = 12345u + static_cast<guint32>(number);
  for (gsize i = 0; i < map.size; ++i) {
    state = state * 1664525u + 1013904223u;
    map.data[i] = static_cast<guint8>(state >> 24);
  }
  gst_buffer_unmap(buffer, &map);
  return buffer;
}

CerberusPose pose(double pan, double tilt = 0, GstClockTime from = 0,
                  GstClockTime until = GST_CLOCK_TIME_NONE) {
  CerberusPose p;
  cerberus_pose_init(&p);
  p.pan = pan, p.tilt = tilt;
  p.valid_from = from, p.valid_until = until;
  return p;
}

void tell(GstHarness* h, const CerberusPose& p) {
  gst_harness_push_upstream_event(h, cerberus_event_new_pose(&p));
}

struct Ptz {
  Harness h;
  GstVideoInfo in = info_of(caps_string("I420", kWidth, kHeight)),
               out = info_of(caps_string("I420", kWindowWidth, kWindowHeight));
  explicit Ptz(const std::string& line = kLine, bool live = true, const char* format = "I420")
      : h(harness(line.c_str())) {
    in = info_of(caps_string(format, kWidth, kHeight));
    out = info_of(caps_string(format, kWindowWidth, kWindowHeight));
    gst_harness_set_live(h.get(), live);
    gst_harness_set_src_caps_str(h.get(), caps_string(format, kWidth, kHeight).c_str());
  }
  GstBuffer* through(int number) {
    fail_unless_equals_int(gst_harness_push(h.get(), noise(in, number)), GST_FLOW_OK);
    return gst_harness_pull(h.get());
  }
  // Fails unless the window lies at (left, top) on frame `number`.
  void shows(GstBuffer* window, int number, int left, int top) {
    const Picture seen(out, window), whole(in, noise(in, number));
    int wrong = 0;  // fail_unless() writes to a pipe each time
    for (guint c = 0; c < GST_VIDEO_FRAME_N_COMPONENTS(&seen.frame); ++c) {
      const int sub_x = GST_VIDEO_FORMAT_INFO_W_SUB(in.finfo, c),
                sub_y = GST_VIDEO_FORMAT_INFO_H_SUB(in.finfo, c);
      for (int y = 0; y < GST_VIDEO_FRAME_COMP_HEIGHT(&seen.frame, c); ++y)
        for (int x = 0; x < GST_VIDEO_FRAME_COMP_WIDTH(&seen.frame, c); ++x)
          wrong += seen.at(c, x, y) != whole.at(c, x + (left >> sub_x), y + (top >> sub_y));
    }
    fail_unless_equals_int(wrong, 0);
  }
  void frame_shows(int number, int left, int top) { shows(through(number), number, left, top); }
};

// A push in a thread of its own, for frames that wait.
struct Push {
  GstFlowReturn flow = GST_FLOW_OK;
  std::thread thread;
  Push(Ptz& ptz, int number)
      : thread([this, &ptz, number] { flow = gst_harness_push(ptz.h.get(), noise(ptz.in, number)); }) {}
  GstFlowReturn result() {
    thread.join();
    return flow;
  }
};

double property(const Ptz& ptz, const char* name) {
  gdouble value = 0;
  GstElement* element = gst_harness_find_element(ptz.h.get(), "virtualptz");
  g_object_get(element, name, &value, nullptr);
  gst_object_unref(element);
  return value;
}

}  // namespace

GST_START_TEST(the_window_is_the_middle_of_the_picture_in_every_format) {
  for (const char* format : kFormats) {
    Ptz ptz(kLine, true, format);
    ptz.frame_shows(0, 80, 60);
  }
}
GST_END_TEST

GST_START_TEST(a_pose_moves_the_window_in_every_format) {
  for (const char* format : kFormats) {
    Ptz ptz(kLine, true, format);
    ptz.frame_shows(0, 80, 60);
    tell(ptz.h.get(), pose(kForty));
    ptz.frame_shows(1, 120, 60);
    tell(ptz.h.get(), pose(-kForty));
    ptz.frame_shows(2, 40, 60);
    tell(ptz.h.get(), pose(0, kForty));
    ptz.frame_shows(3, 80, 20);
  }
}
GST_END_TEST

GST_START_TEST(the_window_begins_where_it_is_told_to) {
  Ptz ptz(kLine + "start-pan=8.2132107 start-tilt=-89");
  ptz.frame_shows(0, 120, 120);
}
GST_END_TEST

GST_START_TEST(between_pixels_it_interpolates) {
  // Columns 10 and 20 by turns; by a quarter of a pixel to the right (pan = atan(0.25 / F)) everything is 12.5 or 17.5.
  Ptz ptz(kLine, true, "GRAY8");
  GstBuffer* stripes = frame(ptz.in);
  GstMapInfo map;
  gst_buffer_map(stripes, &map, GST_MAP_WRITE);
  for (gsize i = 0; i < map.size; ++i) map.data[i] = i % 2 ? 20 : 10;
  gst_buffer_unmap(stripes, &map);
  gst_harness_push(ptz.h.get(), gst_buffer_copy_deep(stripes));
  gst_buffer_unref(gst_harness_pull(ptz.h.get()));
  tell(ptz.h.get(), pose(std::atan(0.25 / 277.128) * 180 / M_PI));
  GST_BUFFER_PTS(stripes) = 40 * GST_MSECOND;
  gst_harness_push(ptz.h.get(), stripes);
  const Picture seen(ptz.out, gst_harness_pull(ptz.h.get()));
  for (int x = 0; x < kWindowWidth; ++x) fail_unless_equals_int(seen.at(0, x, 7), x % 2 ? 18 : 13);
}
GST_END_TEST

GST_START_TEST(a_moving_pose_is_evaluated_at_the_frames_time) {
  Ptz ptz;
  ptz.frame_shows(0, 80, 60);
  CerberusPose p = pose(0);
  p.pan_speed = kForty / 0.040;
  p.valid_until = 40 * GST_MSECOND;
  p.moving = TRUE;
  tell(ptz.h.get(), p);
  ptz.frame_shows(1, 120, 60);
}
GST_END_TEST

GST_START_TEST(poses_are_passed_on_and_only_those_of_the_own_head_count) {
  Ptz ptz;
  ptz.frame_shows(0, 80, 60);
  CerberusPose stranger = pose(kForty);
  cerberus_pose_set_head(&stranger, "another");
  tell(ptz.h.get(), stranger);
  gst_harness_push_upstream_event(
      ptz.h.get(),
      gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM,
                           gst_structure_new(CERBERUS_EVENT_POSE, "pan", G_TYPE_STRING, "x", nullptr)));
  ptz.frame_shows(1, 80, 60);
  tell(ptz.h.get(), pose(kForty));
  ptz.frame_shows(2, 120, 60);
  int passed = 0;
  while (GstEvent* event = gst_harness_try_pull_upstream_event(ptz.h.get())) {
    passed += gst_event_has_name(event, CERBERUS_EVENT_POSE);
    gst_event_unref(event);
  }
  fail_unless_equals_int(passed, 3);
}
GST_END_TEST

GST_START_TEST(a_frame_carries_the_pose_it_was_made_with) {
  Ptz ptz;
  GstBuffer* out = ptz.through(0);
  fail_unless_equals_float(cerberus_buffer_peek_pose(out)->pan, 0);
  fail_unless_equals_string(cerberus_buffer_peek_pose(out)->head, "head");
  gst_buffer_unref(out);
  CerberusPose p = pose(80, 3);
  p.source = CERBERUS_POSE_MEASURED;
  tell(ptz.h.get(), p);
  out = ptz.through(1);
  const CerberusPose* made = cerberus_buffer_peek_pose(out);
  fail_unless(std::abs(made->pan - 16.102) < 1e-3, "pan %g: the picture ends there", made->pan);
  fail_unless(std::abs(made->tilt - 3) < 1e-6);
  fail_unless_equals_uint64(made->valid_from, 40 * GST_MSECOND);
  fail_unless(made->source == CERBERUS_POSE_MEASURED);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(a_pose_and_regions_of_the_wide_picture_do_not_come_through) {
  Ptz ptz;
  GstBuffer* in = noise(ptz.in, 0);
  const CerberusPose foreign = pose(5, 5);
  cerberus_buffer_set_pose(in, &foreign);
  add(in, region(1, 10, 10, 20, 20));
  gst_harness_push(ptz.h.get(), in);
  GstBuffer* out = gst_harness_pull(ptz.h.get());
  fail_unless_equals_float(cerberus_buffer_peek_pose(out)->pan, 0);
  GPtrArray* regions = cerberus_buffer_get_regions(out);
  fail_unless_equals_int(regions->len, 0);
  g_ptr_array_unref(regions);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(out), 40 * GST_MSECOND);
  gst_buffer_unref(out);
}
GST_END_TEST

// A window does not move quite as a head turns; nobody must take the difference for a robot that does.
GST_START_TEST(its_base_stands_unless_somebody_upstream_knows) {
  Ptz ptz;
  GstBuffer* out = ptz.through(0);
  const CerberusBase* base = cerberus_buffer_peek_base(out);
  fail_unless(base && base->told && base->yaw_rate == 0);
  gst_buffer_unref(out);
  GstBuffer* in = noise(ptz.in, 1);
  CerberusBase turning;
  cerberus_base_init(&turning);
  turning.yaw_rate = -8;
  cerberus_buffer_set_base(in, &turning);
  tell(ptz.h.get(), pose(0, 0));
  gst_harness_push(ptz.h.get(), in);
  out = gst_harness_pull(ptz.h.get());
  base = cerberus_buffer_peek_base(out);
  fail_unless(base && !base->told && base->yaw_rate == -8);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(it_says_how_far_it_reaches) {
  Ptz ptz;
  gst_buffer_unref(ptz.through(0));
  fail_unless(std::abs(property(ptz, "pan-min") + 16.102) < 1e-3);
  fail_unless(std::abs(property(ptz, "pan-max") - 16.102) < 1e-3);
  fail_unless(std::abs(property(ptz, "tilt-min") + 12.216) < 1e-3);
  fail_unless(std::abs(property(ptz, "tilt-max") - 12.216) < 1e-3);
  fail_unless(std::abs(property(ptz, "window-fov") - 32.204) < 1e-3);
}
GST_END_TEST

GST_START_TEST(downstream_may_choose_the_size) {
  Harness h = harness("virtualptz");
  gst_harness_set_sink_caps_str(h.get(), "video/x-raw,width=100,height=50");
  gst_harness_set_src_caps_str(h.get(), caps_string("GRAY8", kWidth, kHeight).c_str());
  gst_harness_push(h.get(), frame(info_of(caps_string("GRAY8", kWidth, kHeight))));
  GstBuffer* out = gst_harness_pull(h.get());
  fail_unless_equals_uint64(gst_buffer_get_size(out), info_of(caps_string("GRAY8", 100, 50)).size);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(the_picture_may_change_its_size_on_the_way) {
  Ptz ptz;
  ptz.frame_shows(0, 80, 60);
  gst_harness_set_src_caps_str(ptz.h.get(), caps_string("I420", 640, 480).c_str());
  ptz.in = info_of(caps_string("I420", 640, 480));
  ptz.frame_shows(1, 240, 180);
}
GST_END_TEST

GST_START_TEST(what_does_not_fit_is_an_error_that_says_so) {
  for (const char* more : {"width=321 height=100", "width=160 height=120 wide-fov=60 horizontal-fov=61"}) {
    Harness h = harness((std::string("virtualptz ") + more).c_str());
    Bus bus(h.get());
    gst_harness_set_src_caps_str(h.get(), caps_string("GRAY8", kWidth, kHeight).c_str());
    fail_unless_equals_int(gst_harness_push(h.get(), frame(info_of(caps_string("GRAY8", kWidth, kHeight)))),
                           GST_FLOW_NOT_NEGOTIATED);
    std::string text;
    fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR, &text), 1);
    fail_unless(text.find("does not fit into the picture of 320 x 240") != std::string::npos, "%s",
                text.c_str());
  }
}
GST_END_TEST

GST_START_TEST(a_buffer_without_its_picture_is_passed_on_as_such) {
  Ptz ptz;
  Bus bus(ptz.h.get());
  for (int number = 0; number < 2; ++number) {
    GstBuffer* stub = noise(ptz.in, number);
    gst_buffer_set_size(stub, 100);
    fail_unless_equals_int(gst_harness_push(ptz.h.get(), stub), GST_FLOW_OK);
    GstBuffer* out = gst_harness_pull(ptz.h.get());
    fail_unless(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_CORRUPTED));
    gst_buffer_unref(out);
  }
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
  ptz.frame_shows(2, 80, 60);
}
GST_END_TEST

GST_START_TEST(not_live_a_frame_waits_for_its_pose) {
  Ptz ptz(kLine, false);
  ptz.frame_shows(0, 80, 60);
  for (int number = 1; number < 20; ++number) {
    // A pose of the time before wakes nobody.
    tell(ptz.h.get(), pose(0, 0, (number - 1) * 40 * GST_MSECOND, (number * 40 - 1) * GST_MSECOND));
    Push push(ptz, number);
    tell(ptz.h.get(),
         pose(number % 2 ? kForty : 0, 0, (number * 40 - 1) * GST_MSECOND, number * 40 * GST_MSECOND));
    fail_unless_equals_int(push.result(), GST_FLOW_OK);
    ptz.shows(gst_harness_pull(ptz.h.get()), number, number % 2 ? 120 : 80, 60);
  }
}
GST_END_TEST

// A head that knows of no frame to come stays silent, and tells its way through a gap when it hears of one.
struct Silent {
  GstHarness* h;
  std::vector<std::pair<GstClockTime, GstClockTime>> gaps;
  explicit Silent(GstHarness* harness) : h(harness) {
    gst_pad_add_probe(
        h->sinkpad, GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM,
        [](GstPad*, GstPadProbeInfo* info, gpointer data) {
          GstEvent* event = GST_PAD_PROBE_INFO_EVENT(info);
          if (GST_EVENT_TYPE(event) != GST_EVENT_GAP) return GST_PAD_PROBE_OK;
          auto* self = static_cast<Silent*>(data);
          auto& gap = self->gaps.emplace_back();
          gst_event_parse_gap(event, &gap.first, &gap.second);
          tell(self->h, pose(kForty, 0, gap.first, gap.first + gap.second));
          return GST_PAD_PROBE_OK;
        },
        this, nullptr);
  }
};

GST_START_TEST(where_frames_are_missing_those_behind_are_told) {
  Ptz ptz(kLine + "lockstep-timeout=1000000", false);
  Silent silent(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  ptz.frame_shows(5, 120, 60);
  tell(ptz.h.get(), pose(0, 0, 200 * GST_MSECOND, 260 * GST_MSECOND));
  ptz.frame_shows(6, 80, 60);
  ptz.frame_shows(8, 120, 60);
  const decltype(silent.gaps) missing = {{40 * GST_MSECOND, 160 * GST_MSECOND},
                                         {280 * GST_MSECOND, 40 * GST_MSECOND}};
  fail_unless(silent.gaps == missing, "%zu gaps", silent.gaps.size());
}
GST_END_TEST

GST_START_TEST(a_stream_without_a_rate_is_full_of_gaps) {
  Ptz ptz(kLine + "lockstep-timeout=1000000", false);
  Silent silent(ptz.h.get());
  gst_harness_set_src_caps_str(
      ptz.h.get(), "video/x-raw,format=I420,width=320,height=240,framerate=0/1,interlace-mode=progressive");
  for (const int number : {0, 1, 3}) {
    GstBuffer* frame = noise(ptz.in, number);
    GST_BUFFER_DURATION(frame) = GST_CLOCK_TIME_NONE;
    fail_unless_equals_int(gst_harness_push(ptz.h.get(), frame), GST_FLOW_OK);
    ptz.shows(gst_harness_pull(ptz.h.get()), number, number ? 120 : 80, 60);
  }
  fail_unless_equals_int(silent.gaps.size(), 2);
  // It begins when the last frame is over, and that one is not of no time at all.
  fail_unless_equals_uint64(silent.gaps[1].first, 40 * GST_MSECOND + 1);
  fail_unless_equals_uint64(silent.gaps[1].first + silent.gaps[1].second, 120 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(a_segment_may_begin_with_a_gap) {
  Ptz ptz(kLine + "lockstep-timeout=1000000", false);
  Silent silent(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  // Running time goes on at 1 s: the first frame's end at 40 ms lies before.
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  segment.start = segment.time = 10 * GST_SECOND;
  segment.base = GST_SECOND;
  gst_harness_push_event(ptz.h.get(), gst_event_new_segment(&segment));
  GstBuffer* frame = noise(ptz.in, 1);
  GST_BUFFER_PTS(frame) = 10 * GST_SECOND + 80 * GST_MSECOND;
  tell(ptz.h.get(), pose(0, 0, GST_SECOND, GST_SECOND + 60 * GST_MSECOND));
  gst_harness_push(ptz.h.get(), frame);
  const decltype(silent.gaps) missing = {{10 * GST_SECOND, 80 * GST_MSECOND}};
  fail_unless(silent.gaps == missing, "%zu gaps", silent.gaps.size());
}
GST_END_TEST

GST_START_TEST(of_two_poses_that_meet_the_earlier_counts_in_lockstep) {
  // The later one may or may not have come in time: the result must not depend on it.
  Ptz ptz(kLine, false);
  ptz.frame_shows(0, 80, 60);
  CerberusPose moving = pose(0, 0, 0, 40 * GST_MSECOND);
  moving.pan_speed = 10;
  moving.moving = TRUE;
  tell(ptz.h.get(), moving);
  tell(ptz.h.get(), pose(0.4, 0, 40 * GST_MSECOND, 80 * GST_MSECOND));
  GstBuffer* out = ptz.through(1);
  fail_unless(cerberus_buffer_peek_pose(out)->moving);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(nobody_waits_in_a_live_pipeline_or_without_lockstep) {
  for (const bool live : {true, false}) {
    Ptz ptz(live ? kLine : kLine + "lockstep=off", live);
    for (int number = 0; number < 3; ++number) ptz.frame_shows(number, 80, 60);
  }
}
GST_END_TEST

GST_START_TEST(a_head_that_never_tells_is_an_error_that_names_it) {
  Ptz ptz(kLine + "head=nobody lockstep-timeout=1000000", false);
  Bus bus(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  tell(ptz.h.get(), pose(0));
  fail_unless_equals_int(gst_harness_push(ptz.h.get(), noise(ptz.in, 1)), GST_FLOW_ERROR);
  std::string text;
  fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR, &text), 1);
  fail_unless(text.find("\"nobody\"") != std::string::npos && text.find("lockstep=off") != std::string::npos,
              "%s", text.c_str());
}
GST_END_TEST

GST_START_TEST(a_flush_and_a_stop_end_the_waiting_at_once) {
  for (const bool flush : {true, false})
    assert_prompt(flush ? "flush" : "stop", [flush] {
      Ptz ptz(kLine, false);
      ptz.frame_shows(0, 80, 60);
      Push push(ptz, 1);
      return time_taken([&] {
        if (flush)
          gst_harness_push_event(ptz.h.get(), gst_event_new_flush_start());
        else
          gst_element_set_state(ptz.h->element, GST_STATE_NULL);
        fail_unless_equals_int(push.result(), GST_FLOW_FLUSHING);
      });
    });
}
GST_END_TEST

GST_START_TEST(after_a_flush_the_window_is_where_it_was) {
  Ptz ptz(kLine, false);
  ptz.frame_shows(0, 80, 60);
  tell(ptz.h.get(), pose(kForty));
  ptz.frame_shows(1, 120, 60);
  push_flush(ptz.h.get());
  ptz.frame_shows(0, 120, 60);
}
GST_END_TEST

GST_START_TEST(angles_may_change_while_it_runs_as_long_as_they_fit) {
  Ptz ptz;
  Bus bus(ptz.h.get());
  ptz.frame_shows(0, 80, 60);
  GstElement* element = gst_harness_find_element(ptz.h.get(), "virtualptz");
  g_object_set(element, "wide-fov", 90.0, nullptr);
  tell(ptz.h.get(), pose(std::atan(40 / 160.0) * 180 / M_PI));
  ptz.frame_shows(1, 120, 60);
  g_object_set(element, "horizontal-fov", 100.0, nullptr);
  ptz.frame_shows(2, 120, 60);
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
  gst_object_unref(element);
}
GST_END_TEST

static Suite* virtualptz_suite() {
  watch_library_log();
  Suite* s = suite_create("virtualptz");
  TCase* tc = tcase_create("window");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_window_is_the_middle_of_the_picture_in_every_format);
  tcase_add_test(tc, a_pose_moves_the_window_in_every_format);
  tcase_add_test(tc, the_window_begins_where_it_is_told_to);
  tcase_add_test(tc, between_pixels_it_interpolates);
  tcase_add_test(tc, a_moving_pose_is_evaluated_at_the_frames_time);
  tcase_add_test(tc, poses_are_passed_on_and_only_those_of_the_own_head_count);
  tcase_add_test(tc, a_frame_carries_the_pose_it_was_made_with);
  tcase_add_test(tc, a_pose_and_regions_of_the_wide_picture_do_not_come_through);
  tcase_add_test(tc, its_base_stands_unless_somebody_upstream_knows);
  tcase_add_test(tc, it_says_how_far_it_reaches);
  tcase_add_test(tc, downstream_may_choose_the_size);
  tcase_add_test(tc, the_picture_may_change_its_size_on_the_way);
  tcase_add_test(tc, what_does_not_fit_is_an_error_that_says_so);
  tcase_add_test(tc, a_buffer_without_its_picture_is_passed_on_as_such);
  tcase_add_test(tc, angles_may_change_while_it_runs_as_long_as_they_fit);
  tc = tcase_create("lockstep");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, not_live_a_frame_waits_for_its_pose);
  tcase_add_test(tc, where_frames_are_missing_those_behind_are_told);
  tcase_add_test(tc, a_stream_without_a_rate_is_full_of_gaps);
  tcase_add_test(tc, a_segment_may_begin_with_a_gap);
  tcase_add_test(tc, of_two_poses_that_meet_the_earlier_counts_in_lockstep);
  tcase_add_test(tc, nobody_waits_in_a_live_pipeline_or_without_lockstep);
  tcase_add_test(tc, a_head_that_never_tells_is_an_error_that_names_it);
  tcase_add_test(tc, a_flush_and_a_stop_end_the_waiting_at_once);
  tcase_add_test(tc, after_a_flush_the_window_is_where_it_was);
  return s;
}

GST_CHECK_MAIN(virtualptz)
