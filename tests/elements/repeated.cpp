// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames that repeat the last picture (GAP, as `videorate` marks them), and frames that stop coming.
#include <memory>
#include <string>
#include <vector>

#include "scene.h"
#include "support.h"

#include <gst/check/gsttestclock.h>

namespace {

using scene::Line;
using scene::Regions;
using scene::World;

const char* const kLines[] = {
    "motiondetect confirm-time=0 ! identity",
    "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack confirm-time=0",
    "motionregions ! identity", "motiontrack confirm-time=0 ! identity"};

// A picture between frame k and k + 1 that is marked GAP; its content is not analysed.
GstBuffer* repeated(int k, int part, int parts) {
  GstBuffer* buffer = gst_buffer_new_allocate(nullptr, scene::kWidth * scene::kHeight, nullptr);
  gst_buffer_memset(buffer, 0, 0, gst_buffer_get_size(buffer));
  GST_BUFFER_PTS(buffer) = k * scene::kStep + part * scene::kStep / parts;
  GST_BUFFER_FLAG_SET(buffer, GST_BUFFER_FLAG_GAP);
  return buffer;
}

// The same picture again without the mark, as videoscale of GStreamer 1.22 leaves it of videorate's duplicates.
GstBuffer* duplicate(const World& world, int k, int part, int parts) {
  GstBuffer* buffer = scene::grey_buffer(world, k);
  GST_BUFFER_PTS(buffer) = k * scene::kStep + part * scene::kStep / parts;
  return buffer;
}

GST_START_TEST(a_repeated_frame_carries_the_regions_of_the_last_picture) {
  const int number = __i__ / 2;
  const bool marked = __i__ % 2;
  Line line(kLines[number]), plain(kLines[number]);
  const World world;
  guint found = 0;
  for (int k = 0; k < 25; ++k) {
    GstBuffer* should = plain.through(scene::grey_buffer(world, k));
    GstBuffer* out = line.through(scene::grey_buffer(world, k));
    const std::string expected = Regions(should).text(), is = Regions(out).text();
    ck_assert_str_eq(is.c_str(), expected.c_str());  // the pictures between change nothing of what is found
    found += Regions(out).size();
    for (int part = 1; part < 3; ++part) {
      if (!marked && k == 0) continue;  // equal pictures at the start of a scene are a still scene
      GstBuffer* again = line.through(marked ? repeated(k, part, 3) : duplicate(world, k, part, 3));
      fail_unless(GST_BUFFER_FLAG_IS_SET(again, GST_BUFFER_FLAG_GAP));
      fail_unless(cerberus_buffer_regions_known(again));
      const Regions before(out), after(again);
      fail_unless_equals_int(after.size(), before.size());
      for (guint i = 0; i < after.size(); ++i) {
        fail_unless(after[i].x == before[i].x);
        fail_unless(after[i].width == before[i].width);
        fail_unless_equals_int(after[i].id, before[i].id);
        if (after[i].tracked)
          fail_unless_equals_uint64(after[i].age, before[i].age + part * (scene::kStep / 3));
      }
      gst_buffer_unref(again);
    }
    gst_buffer_unref(should);
    gst_buffer_unref(out);
  }
  fail_unless(found > 10, "nothing was found at all");
}
GST_END_TEST

// Videoscale of GStreamer 1.22 takes the mark off.
GST_START_TEST(duplicates_that_were_scaled_lose_nobody) {
  Line line(
      "videorate ! video/x-raw,framerate=75/1 ! videoscale ! video/x-raw,width=160,height=120 ! "
      "motiondetect confirm-time=0 analysis-width=160");
  int with = 0, without = 0;
  for (int k = 0; k < 40; ++k) {
    fail_unless_equals_int(gst_harness_push(line.harness, scene::grey_buffer(World{}, k)), GST_FLOW_OK);
    while (GstBuffer* out = gst_harness_try_pull(line.harness)) {
      if (Regions(out).size() > 0)
        ++with;
      else if (with > 0)
        ++without;
      gst_buffer_unref(out);
    }
  }
  fail_unless(with > 90, "only %d frames with an object", with);
  fail_unless_equals_int(without, 0);
}
GST_END_TEST

GST_START_TEST(the_camera_stands_still_while_a_picture_is_repeated) {
  Line line("motiondetect ! identity");
  World world;
  world.pan = 2;
  line.run(world, 0, 10);
  GstBuffer* last = line.through(scene::grey_buffer(world, 10));
  const CerberusCameraMotion before = *cerberus_buffer_peek_camera_motion(last);
  gst_buffer_unref(last);
  fail_unless(!before.still && before.matrix[2] != 0);
  GstBuffer* again = line.through(repeated(10, 1, 2));
  const CerberusCameraMotion* now = cerberus_buffer_peek_camera_motion(again);
  fail_unless(now && now->still);
  fail_unless(now->matrix[2] == 0);
  fail_unless(now->path[2] == before.path[2]);
  fail_unless_equals_int(now->path_id, before.path_id);
  fail_unless_equals_uint64(now->from, 10 * scene::kStep);
  gst_buffer_unref(again);
}
GST_END_TEST

// coast-time 1 s, hold-time 2 s: the last picture is frame 24, at .96 s.
GST_START_TEST(an_endless_freeze_ends_tracks_after_coast_time_and_motion_after_hold_time) {
  Line line(std::string("motiondetect confirm-time=0 ! identity"));
  line.run(World{}, 0, 25);
  std::vector<std::string> states = line.messages(GST_MESSAGE_ELEMENT);
  fail_unless(!states.empty());
  guint gone = 0, ended = 0;
  for (guint k = 1; k < 100; ++k) {
    GstBuffer* again = line.through(repeated(24 + static_cast<int>(k), 0, 1));
    if (Regions(again).size() == 0 && gone == 0) gone = k;
    for (const std::string& state : line.messages(GST_MESSAGE_ELEMENT))
      if (state == "ended") ended = k;
    gst_buffer_unref(again);
  }
  fail_unless_equals_int(gone, 26);   // 25 frames are the second
  fail_unless_equals_int(ended, 75);  // 50 frames without any object: 26 to 75
}
GST_END_TEST

GST_START_TEST(a_repeated_frame_before_any_picture_carries_nothing) {
  Line line("motiondetect ! identity");
  GstBuffer* out = line.through(repeated(0, 0, 1));
  fail_if(cerberus_buffer_regions_known(out));
  gst_buffer_unref(out);
}
GST_END_TEST

// What a repeated frame is marked with: it does not continue the stream.
GST_START_TEST(a_break_on_a_repeated_frame_ends_the_scene) {
  Line line(kLines[__i__]);
  World world, other;
  other.wall = 5;
  other.start = 250;
  other.speed = -3;
  line.run(world, 0, 25);
  GstBuffer* marked = repeated(25, 0, 1);
  GST_BUFFER_FLAG_SET(marked, GST_BUFFER_FLAG_DISCONT);
  GstBuffer* out = line.through(marked);
  fail_if(cerberus_buffer_regions_known(out), "what it repeats was not seen here");
  gst_buffer_unref(out);
  guint found = 0;
  line.run(other, 26, 50, [&](int k, GstBuffer* buffer) {
    const guint n = Regions(buffer).size();
    fail_unless(k >= 28 || n == 0, "%u regions in frame %d", n, k);
    found += n;
  });
  fail_unless(found > 0, "nothing was found any more");
}
GST_END_TEST

// A leaky queue marks what follows the frames that it dropped.
GST_START_TEST(a_mark_of_dropped_frames_on_a_repeated_frame_ends_no_scene) {
  Line line(kLines[__i__]);
  const World world;
  line.run(world, 0, 25);
  GstBuffer* marked = repeated(27, 0, 1);
  GST_BUFFER_FLAG_SET(marked, GST_BUFFER_FLAG_DISCONT);
  GstBuffer* out = line.through(marked);
  fail_unless(Regions(out).size() > 0);
  gst_buffer_unref(out);
  line.run(world, 28, 29, [](int, GstBuffer* buffer) { fail_unless(Regions(buffer).size() > 0); });
}
GST_END_TEST

// A head at 5 degrees that turns by 10 degrees a second; the base turns by 3.
GST_START_TEST(a_repeated_frame_has_the_pose_of_its_picture_and_the_rate_of_the_base) {
  for (const bool carried : {false, true}) {
    Line line("motiondetect name=motion horizontal-fov=60 ! identity");
    for (int k = 0; k < 3; ++k) {
      GstBuffer* in = scene::grey_buffer(World{}, k);
      CerberusPose pose;
      cerberus_pose_init(&pose);
      cerberus_pose_set_head(&pose, "head");
      pose.pan = 5 + .4 * k;
      pose.pan_speed = 10;
      pose.valid_from = k * scene::kStep;
      if (carried)
        cerberus_buffer_set_pose(in, &pose);
      else
        gst_harness_push_upstream_event(line.harness, cerberus_event_new_pose(&pose));
      gst_harness_push_upstream_event(line.harness, base_event(3, k * scene::kStep));
      gst_buffer_unref(line.through(in));
    }
    GstBuffer* again = line.through(repeated(2, 1, 2));
    const CerberusPose* pose = cerberus_buffer_peek_pose(again);
    fail_unless(pose);
    fail_unless_equals_string(pose->head, "head");
    double pan = 0;
    cerberus_pose_evaluate(pose, GST_BUFFER_PTS(again), &pan, nullptr);
    fail_unless(std::abs(pan - 5.8) < 1e-9, "%g", pan);
    cerberus_pose_evaluate(pose, GST_BUFFER_PTS(again) + GST_SECOND, &pan, nullptr);
    fail_unless(std::abs(pan - 5.8) < 1e-9, "%g", pan);
    const CerberusBase* base = cerberus_buffer_peek_base(again);
    fail_unless(base && base->yaw_rate == 3 && base->source == CERBERUS_BASE_REPORTED);
    gst_buffer_unref(again);
  }
}
GST_END_TEST

// One frame's time is hours ahead. It counts at its place in the stream, so that the base's rates of later frames stay.
GST_START_TEST(a_repeated_frame_whose_time_is_far_off_counts_at_its_place) {
  for (const GstBufferFlags mark : {GST_BUFFER_FLAG_GAP, GST_BUFFER_FLAG_CORRUPTED}) {
    Line line("motiondetect name=motion horizontal-fov=60 ! identity");
    for (int k = 0; k < 20; ++k)
      gst_harness_push_upstream_event(line.harness, base_event(k, k * scene::kStep));
    for (int k = 0; k < 20; ++k) {
      GstBuffer* in = scene::grey_buffer(World{}, k);
      if (k == 10) {
        GST_BUFFER_PTS(in) += 5 * 3600 * GST_SECOND;
        GST_BUFFER_FLAG_SET(in, mark);
      }
      GstBuffer* out = line.through(in);
      const CerberusBase* base = cerberus_buffer_peek_base(out);
      fail_unless(base && base->source == CERBERUS_BASE_REPORTED && base->yaw_rate == k, "frame %d: %g", k,
                  base ? base->yaw_rate : -1);
      gst_buffer_unref(out);
    }
  }
}
GST_END_TEST

// But for the trails, which fade with time.
GST_START_TEST(a_repeated_frame_is_drawn_on_as_its_picture_was) {
  Line line("motiondetect confirm-time=0 ! motionoverlay show-trails=false",
            scene::caps("I420", scene::kWidth, scene::kHeight));
  const World world;
  const auto picture = [&](int k) {
    return scene::buffer("I420", scene::kWidth, scene::kHeight, world.picture(k), k * scene::kStep);
  };
  for (int k = 0; k < 24; ++k) gst_buffer_unref(line.through(picture(k)));
  GstBuffer* drawn = line.through(picture(24));
  fail_unless(Regions(drawn).size() > 0);
  GstBuffer* in = picture(24);
  GstMapInfo plain, once, twice;
  GST_BUFFER_PTS(in) += scene::kStep / 2;
  GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
  GstBuffer* original = gst_buffer_copy_deep(in);
  GstBuffer* again = line.through(in);
  fail_unless(gst_buffer_map(original, &plain, GST_MAP_READ) && gst_buffer_map(drawn, &once, GST_MAP_READ) &&
              gst_buffer_map(again, &twice, GST_MAP_READ));
  fail_unless(memcmp(once.data, plain.data, plain.size) != 0, "nothing was drawn");
  fail_unless(memcmp(once.data, twice.data, plain.size) == 0, "a repeated frame looks different");
  gst_buffer_unmap(original, &plain);
  gst_buffer_unmap(drawn, &once);
  gst_buffer_unmap(again, &twice);
  for (GstBuffer* each : {original, drawn, again}) gst_buffer_unref(each);
}
GST_END_TEST

// Frames: keyframe, predicted, predicted after a loss, predicted, keyframe, predicted.
GST_START_TEST(encoded_frames_from_a_loss_to_the_next_keyframe_are_marked) {
  Line line("streamdamage ! identity", "video/x-h264,stream-format=avc,alignment=au");
  const bool predicted[] = {false, true, true, true, false, true};
  const bool marked[] = {false, false, true, true, false, false};
  for (int k = 0; k < 6; ++k) {
    GstBuffer* in = gst_buffer_new_memdup("frame", 5);
    GST_BUFFER_PTS(in) = k * scene::kStep;
    if (predicted[k]) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DELTA_UNIT);
    if (k == 0 || k == 2) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT);
    GstBuffer* out = line.through(in);
    fail_unless_equals_int(gst_buffer_get_custom_meta(out, "CerberusDamagedPicture") != nullptr, marked[k]);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(a_damaged_picture_counts_as_the_last_whole_one) {
  Line line(kLines[__i__]), plain(kLines[__i__]);
  const World world;
  guint found = 0;
  for (int k = 0; k < 40; ++k) {
    const bool damaged = k >= 25 && k < 30;
    GstBuffer* in = damaged ? repeated(k, 0, 1) : scene::grey_buffer(world, k);
    GST_BUFFER_FLAG_UNSET(in, GST_BUFFER_FLAG_GAP);
    if (damaged) gst_buffer_add_custom_meta(in, "CerberusDamagedPicture");
    GstBuffer* out = line.through(in);
    GstBuffer* should = plain.through(damaged ? repeated(k, 0, 1) : scene::grey_buffer(world, k));
    fail_unless_equals_int(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_CORRUPTED), damaged);
    fail_unless_equals_int(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_GAP), damaged);
    fail_unless(Regions(out).text() == Regions(should).text());
    found += damaged ? Regions(out).size() : 0;
    gst_buffer_unref(out);
    gst_buffer_unref(should);
  }
  fail_unless(found > 0, "nothing was found at all");
}
GST_END_TEST

// ---- frames that stop coming

// A figure that is seen until frame 24, and then nothing; a clock that goes by hand.
struct Stopped {
  Line line;
  GstTestClock* clock;
  explicit Stopped(bool live = true, const char* launch = "motiondetect confirm-time=0 ! identity")
      : line(launch, "") {
    gst_harness_use_testclock(line.harness);
    gst_harness_set_live(line.harness, live);
    clock = gst_harness_get_testclock(line.harness);
    gst_harness_set_src_caps_str(line.harness, scene::caps("GRAY8", scene::kWidth, scene::kHeight).c_str());
    for (int k = 0; k < 25; ++k) {
      gst_test_clock_set_time(clock, k * scene::kStep);
      gst_buffer_unref(line.through(scene::grey_buffer(World{}, k)));
    }
    fail_unless_equals_int(count("started"), 1);
  }
  ~Stopped() { gst_object_unref(clock); }
  int count(const std::string& state, GstClockTime* when = nullptr) {
    int n = 0;
    while (GstMessage* message = gst_bus_pop_filtered(line.bus, GST_MESSAGE_ELEMENT)) {
      const GstStructure* s = gst_message_get_structure(message);
      if (gst_structure_has_name(s, "cerberus-motion") && state == gst_structure_get_string(s, "state")) {
        ++n;
        if (when) gst_structure_get_uint64(s, "running-time", when);
      }
      gst_message_unref(message);
    }
    return n;
  }
  // Time goes on; what waits for it until then is woken.
  void wait_until(GstClockTime time) {
    for (GstClockID id; gst_test_clock_peek_next_pending_id(clock, &id); gst_clock_id_unref(id)) {
      const bool due = gst_clock_id_get_time(id) <= time;
      if (due) gst_test_clock_crank(clock);
      if (!due) {
        gst_clock_id_unref(id);
        break;
      }
    }
    gst_test_clock_set_time(clock, time);
  }
};

GST_START_TEST(live_motion_ends_by_the_clock_when_frames_stop) {
  Stopped stream;
  const GstClockTime last = 24 * scene::kStep;
  stream.wait_until(last + 2 * GST_SECOND - 1);
  fail_unless_equals_int(stream.count("ended"), 0);
  GstClockTime when = 0;
  stream.wait_until(last + 2 * GST_SECOND);
  fail_unless_equals_int(stream.count("ended", &when), 1);
  fail_unless_equals_uint64(when, last + 2 * GST_SECOND);
  fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 0);
  stream.wait_until(100 * GST_SECOND);
  fail_unless_equals_int(stream.count("ended"), 0);
}
GST_END_TEST

GST_START_TEST(there_is_one_timer_however_many_frames_come) {
  Stopped stream;
  fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 1);
}
GST_END_TEST

GST_START_TEST(what_is_not_live_is_not_watched_by_the_clock) {
  Stopped stream(false);
  fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 0);
  stream.wait_until(100 * GST_SECOND);
  fail_unless_equals_int(stream.count("ended"), 0);
}
GST_END_TEST

GST_START_TEST(a_pause_a_flush_and_the_end_of_the_stream_stop_the_timer) {
  {
    Stopped stream;
    gst_element_set_state(stream.line.harness->element, GST_STATE_PAUSED);
    fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 0);
    gst_element_set_state(stream.line.harness->element, GST_STATE_PLAYING);
    fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 1);
    gst_element_set_state(stream.line.harness->element, GST_STATE_READY);
    fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 0);
    fail_unless_equals_int(stream.count("ended"), 1);
  }
  Stopped stream;
  gst_harness_push_event(stream.line.harness, gst_event_new_flush_start());
  fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 0);
  gst_harness_push_event(stream.line.harness, gst_event_new_flush_stop(TRUE));
  push_segment(stream.line.harness);
  gst_buffer_unref(stream.line.through(scene::grey_buffer(World{}, 0)));
  fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 1);
  gst_harness_push_event(stream.line.harness, gst_event_new_eos());
  fail_unless_equals_int(gst_test_clock_peek_id_count(stream.clock), 0);
  fail_unless_equals_int(stream.count("ended"), 1);
}
GST_END_TEST

// A handler that receives the message synchronously may call the element: no lock is held.
GST_START_TEST(no_lock_is_held_while_the_end_is_posted) {
  Stopped stream;
  gst_bus_set_sync_handler(
      stream.line.bus,
      [](GstBus*, GstMessage* message, gpointer data) {
        if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ELEMENT)
          gst_buffer_unref(static_cast<Stopped*>(data)->line.through(scene::grey_buffer(World{}, 25)));
        return GST_BUS_PASS;
      },
      &stream, nullptr);
  stream.wait_until(10 * GST_SECOND);
  gst_bus_set_sync_handler(stream.line.bus, nullptr, nullptr, nullptr);
}
GST_END_TEST

Suite* repeated_suite() {
  Suite* suite = suite_create("repeated");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, a_repeated_frame_carries_the_regions_of_the_last_picture, 0,
                      2 * G_N_ELEMENTS(kLines));
  tcase_add_test(tests, duplicates_that_were_scaled_lose_nobody);
  tcase_add_test(tests, the_camera_stands_still_while_a_picture_is_repeated);
  tcase_add_test(tests, an_endless_freeze_ends_tracks_after_coast_time_and_motion_after_hold_time);
  tcase_add_test(tests, a_repeated_frame_before_any_picture_carries_nothing);
  tcase_add_loop_test(tests, a_break_on_a_repeated_frame_ends_the_scene, 0, G_N_ELEMENTS(kLines));
  // Without cameramotion such a mark cannot be distinguished from a cut.
  tcase_add_loop_test(tests, a_mark_of_dropped_frames_on_a_repeated_frame_ends_no_scene, 0, 2);
  tcase_add_test(tests, a_repeated_frame_is_drawn_on_as_its_picture_was);
  tcase_add_test(tests, a_repeated_frame_has_the_pose_of_its_picture_and_the_rate_of_the_base);
  tcase_add_test(tests, a_repeated_frame_whose_time_is_far_off_counts_at_its_place);
  tcase_add_test(tests, encoded_frames_from_a_loss_to_the_next_keyframe_are_marked);
  tcase_add_loop_test(tests, a_damaged_picture_counts_as_the_last_whole_one, 0, G_N_ELEMENTS(kLines));
  tcase_add_test(tests, live_motion_ends_by_the_clock_when_frames_stop);
  tcase_add_test(tests, there_is_one_timer_however_many_frames_come);
  tcase_add_test(tests, what_is_not_live_is_not_watched_by_the_clock);
  tcase_add_test(tests, a_pause_a_flush_and_the_end_of_the_stream_stop_the_timer);
  tcase_add_test(tests, no_lock_is_held_while_the_end_is_posted);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(repeated);
