// SPDX-License-Identifier: LGPL-2.1-or-later
// What motiondetect and motiontrack post about motion and tracks: when, of what, by which camera.
#include <map>
#include <string>
#include <vector>

#include "annotated.h"
#include "scene.h"

namespace {

using scene::kStep;
using scene::Line;
using scene::Regions;
using scene::World;

const char* const kElements[] = {"motiondetect", "motiontrack"};
constexpr GstClockTime k2023 = G_GUINT64_CONSTANT(1700000000123456789);  // 2023-11-14 22:13:20 UTC

struct Posted {
  std::string state;  // of a track, or started or ended
  bool is_track = false;
  CerberusTrack track;
  GstClockTime running_time, utc;
  CerberusUtcSource source;
  std::string camera;
};

std::vector<Posted> posted(GstBus* bus) {
  std::vector<Posted> all;
  while (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ELEMENT)) {
    g_autoptr(CerberusStamp) stamp = cerberus_message_parse_stamp(message);
    g_autoptr(CerberusTrack) track = cerberus_message_parse_track(message);
    fail_unless(stamp && (track || cerberus_message_is_motion(message)));
    Posted& p = all.emplace_back();
    p.state = gst_structure_get_string(gst_message_get_structure(message), "state");
    p.is_track = track != nullptr;
    if (track) p.track = *track;
    p.running_time = stamp->running_time;
    p.utc = stamp->utc;
    p.source = stamp->utc_source;
    p.camera = stamp->camera_name ? stamp->camera_name : "";
    gst_message_unref(message);
  }
  return all;
}

// What a frame carried of one track.
using Seen = std::map<GstClockTime, CerberusRegion>;

void remember(std::map<guint, Seen>& tracks, int frame, GstBuffer* out) {
  const Regions regions(out);
  for (guint i = 0; i < regions.size(); ++i) tracks[regions[i].id][frame * kStep] = regions[i];
}

// The messages of one track against the frames that carried it.
void check_track(const std::vector<Posted>& messages, guint id, const Seen& seen, bool with_the_stream,
                 GstClockTime end) {
  std::vector<const Posted*> own;
  for (const Posted& p : messages)
    if (p.is_track && p.track.region.id == id) own.push_back(&p);
  const GstClockTime begin = seen.begin()->first, last = seen.rbegin()->first;
  fail_unless_equals_int(own.size(), 2 + (last - begin) / GST_SECOND);
  for (std::size_t i = 0; i < own.size(); ++i) {
    const Posted& p = *own[i];
    const bool left = i + 1 == own.size();
    fail_unless_equals_string(p.state.c_str(), i == 0 ? "appeared" : left ? "left" : "updated");
    fail_unless_equals_uint64(p.running_time, left ? end : begin + i * GST_SECOND);
    fail_unless_equals_uint64(p.track.first, begin);
    fail_unless_equals_uint64(p.track.last, left ? last : p.running_time);
    annotated::assert_same(p.track.region, seen.at(p.track.last));
    fail_unless_equals_int(p.track.region.kind, seen.at(p.track.last).kind);
  }
  fail_unless(with_the_stream || last < end);
}

}  // namespace

GST_START_TEST(a_track_appears_is_updated_once_a_second_and_leaves_with_the_stream) {
  Line line(std::string(kElements[__i__]) + " ! identity");
  std::map<guint, Seen> tracks;
  constexpr int kFrames = 80;
  line.run(World{}, 0, kFrames, [&](int k, GstBuffer* out) { remember(tracks, k, out); });
  fail_unless_equals_int(tracks.size(), 1);
  const auto& [id, seen] = *tracks.begin();
  fail_unless(seen.rbegin()->first - seen.begin()->first > 2 * GST_SECOND);
  fail_unless_equals_int(seen.rbegin()->first, (kFrames - 1) * kStep);
  gst_harness_push_event(line.harness, gst_event_new_eos());
  const std::vector<Posted> messages = posted(line.bus);
  check_track(messages, id, seen, true, (kFrames - 1) * kStep);
  fail_unless_equals_string(messages.front().state.c_str(), "started");
  fail_unless_equals_string(messages.back().state.c_str(), "ended");
  gst_element_set_state(line.harness->element, GST_STATE_READY);
  fail_unless(posted(line.bus).empty(), "once");
}
GST_END_TEST

GST_START_TEST(a_track_leaves_after_hold_time_and_then_motion_ends) {
  Line line(std::string(kElements[__i__]) + " coast-time=0 hold-stopped=0 hold-time=400000000 ! identity");
  World world;
  world.start = 200;
  world.speed = 4;
  std::map<guint, Seen> tracks;
  line.run(world, 0, 80, [&](int k, GstBuffer* out) { remember(tracks, k, out); });
  fail_unless_equals_int(tracks.size(), 1);
  const auto& [id, seen] = *tracks.begin();
  const std::vector<Posted> messages = posted(line.bus);
  check_track(messages, id, seen, false, seen.rbegin()->first + 400 * GST_MSECOND);
  fail_unless_equals_string(messages[messages.size() - 2].state.c_str(), "left");
  fail_unless_equals_string(messages.back().state.c_str(), "ended");
  fail_unless_equals_uint64(messages.back().running_time, messages[messages.size() - 2].running_time);
}
GST_END_TEST

GST_START_TEST(messages_and_frames_say_when_and_by_which_camera) {
  Line line(std::string(kElements[__i__]) + " camera-name=yard ! identity");
  g_autoptr(GstCaps) reference = gst_caps_from_string("timestamp/x-unix");
  constexpr int kFrames = 40;
  for (int k = 0; k < kFrames; ++k) {
    GstBuffer* in = scene::grey_buffer(World{}, k);
    gst_buffer_add_reference_timestamp_meta(in, reference, k2023 + k * kStep, GST_CLOCK_TIME_NONE);
    GstBuffer* out = line.through(in);
    const CerberusStamp* stamp = cerberus_buffer_peek_stamp(out);
    fail_unless(stamp && stamp->utc == k2023 + k * kStep);
    fail_unless_equals_string(stamp->camera_name, "yard");
    gst_buffer_unref(out);
  }
  gst_harness_push_event(line.harness, gst_event_new_eos());
  const std::vector<Posted> messages = posted(line.bus);
  fail_unless(messages.size() >= 4);
  for (const Posted& p : messages) {
    fail_unless_equals_string(p.camera.c_str(), "yard");
    fail_unless_equals_int(p.source, CERBERUS_UTC_REFERENCE_TIMESTAMP);
    fail_unless_equals_uint64(p.utc, k2023 + p.running_time);
  }
}
GST_END_TEST

GST_START_TEST(without_a_name_and_a_wall_clock_nothing_is_made_up) {
  Line line(std::string(kElements[__i__]) + " ! identity");
  gst_harness_set_live(line.harness, FALSE);
  line.run(World{}, 0, 20, [](int, GstBuffer* out) { fail_if(cerberus_buffer_peek_stamp(out)); });
  const std::vector<Posted> messages = posted(line.bus);
  fail_unless(!messages.empty());
  for (const Posted& p : messages) {
    fail_unless(p.camera.empty());
    fail_unless_equals_uint64(p.utc, GST_CLOCK_TIME_NONE);
  }
}
GST_END_TEST

static Suite* track_messages_suite() {
  watch_library_log();
  Suite* s = suite_create("track_messages");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 60);
  constexpr int kCount = G_N_ELEMENTS(kElements);
  tcase_add_loop_test(tc, a_track_appears_is_updated_once_a_second_and_leaves_with_the_stream, 0, kCount);
  tcase_add_loop_test(tc, a_track_leaves_after_hold_time_and_then_motion_ends, 0, kCount);
  tcase_add_loop_test(tc, messages_and_frames_say_when_and_by_which_camera, 0, kCount);
  tcase_add_loop_test(tc, without_a_name_and_a_wall_clock_nothing_is_made_up, 0, kCount);
  return s;
}

GST_CHECK_MAIN(track_messages)
