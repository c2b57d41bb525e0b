// SPDX-License-Identifier: LGPL-2.1-or-later
// What begins an event of the recorder, and what it does when files cannot be written.
#include <algorithm>
#include <memory>

#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

constexpr char kRaw[] = "video/x-raw, format=GRAY8, width=320, height=240, framerate=25/1";

// A frame without pixels, analysed: with one track in this state, or with nothing.
GstBuffer* analysed(guint32 number, bool track, CerberusRegionState state = CERBERUS_REGION_SEEN) {
  GstBuffer* buffer = gst_buffer_new();
  GST_BUFFER_PTS(buffer) = number * kFrame;
  g_autoptr(GPtrArray) none = g_ptr_array_new();
  cerberus_buffer_set_regions(buffer, none);
  if (!track) return buffer;
  g_autoptr(CerberusRegion) region = cerberus_region_new();
  region->id = 7;
  region->tracked = TRUE;
  region->state = state;
  region->width = region->height = 20;
  fail_unless(cerberus_buffer_add_region(buffer, region));
  return buffer;
}

std::vector<guint32> recorded(const Rig& rig, const char* name = "/1.mp4") {
  return numbers_of(read_back(rig.folder.path() + name));
}

}  // namespace

GST_START_TEST(a_track_on_the_analysis_pad_is_recorded_however_late_it_comes) {
  const guint32 lag = __i__ == 0 ? 0 : 100;  // 4 s: more than pre-roll and post-roll
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  for (guint32 k = 0; k < 400; ++k) {
    if (k < 300) rig.play_to(k);
    if (k >= lag && k - lag < 300) rig.analysis->push(analysed(k - lag, k - lag >= 80 && k - lag <= 100));
  }
  rig.finish();
  fail_unless_equals_int(rig.folder.files().size(), 1);
  fail_unless(recorded(rig) == range(50, 110));  // 80 - 25 = 55: the GOP of 50; 100 + 10
}
GST_END_TEST

// The object's feet are at (10, 20) of 320 x 240: 28.4 degrees to the left of the axis of a lens of 60 degrees.
GST_START_TEST(zones_of_the_world_follow_the_head) {
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  g_object_set(rig.element, "horizontal-fov", 60.0, "trigger-zones",
               "include world -70,80 -50,80 -50,-80 -70,-80", nullptr);
  rig.start();
  for (guint32 k = 0; k < 300; ++k) {
    rig.play_to(k);
    GstBuffer* buffer = analysed(k, (k >= 80 && k <= 100) || (k >= 150 && k <= 160));
    CerberusPose pose;
    cerberus_pose_init(&pose);
    pose.pan = k < 120 ? 0 : -30;
    cerberus_buffer_set_pose(buffer, &pose);
    rig.analysis->push(buffer);
  }
  rig.finish();
  fail_unless_equals_int(rig.folder.files().size(), 1);
  fail_unless(recorded(rig) == range(120, 170));
}
GST_END_TEST

GST_START_TEST(an_object_that_stands_keeps_an_event_going_but_begins_none) {
  Rig rig;
  rig.analysis = std::make_unique<Stream>(rig.element, "analysis", kRaw);
  rig.start();
  for (guint32 k = 0; k < 300; ++k) {
    rig.play_to(k);
    const bool stands = k < 60 || (k > 100 && k <= 150);
    rig.analysis->push(
        analysed(k, stands || k == 100, k == 100 ? CERBERUS_REGION_SEEN : CERBERUS_REGION_STOPPED));
  }
  rig.finish();
  fail_unless_equals_int(rig.folder.files().size(), 1);
  fail_unless(recorded(rig) == range(70, 160));
}
GST_END_TEST

GST_START_TEST(metadata_on_the_encoded_video_counts_without_an_analysis_pad) {
  Rig rig;
  rig.start();
  for (guint32 k = 0; k < 200; ++k) {
    GstBuffer* buffer = unit(k, k * kFrame, k % 10 == 0, k * kFrame);
    CerberusFusion fusion;
    cerberus_fusion_init(&fusion);
    fusion.action = k == 100 ? CERBERUS_FUSION_SEARCH : CERBERUS_FUSION_HOLD;
    cerberus_buffer_set_fusion(buffer, &fusion);
    if (k == 0) g_object_set(rig.element, "trigger-fusion", TRUE, nullptr);
    rig.video->push(buffer);
  }
  rig.finish();
  fail_unless_equals_int(rig.folder.files().size(), 1);
  fail_unless(recorded(rig) == range(70, 110));
}
GST_END_TEST

GST_START_TEST(messages_of_motion_begin_and_end_an_event) {
  Rig rig;
  rig.start();
  const auto tell = [&](CerberusMotionState state, guint32 number) {
    CerberusMotion motion;
    cerberus_motion_init(&motion);
    motion.state = state;
    const CerberusStamp stamp = stamp_at(number * kFrame);
    g_autoptr(GstMessage) message = cerberus_message_new_motion(nullptr, &stamp, &motion);
    g_signal_emit_by_name(rig.element, "handle-message", message);
  };
  rig.play_to(60);
  tell(CERBERUS_MOTION_STARTED, 60);
  rig.play_to(120);
  tell(CERBERUS_MOTION_ENDED, 120);
  rig.play_to(300);
  rig.finish();
  fail_unless(recorded(rig) == range(30, 130));
}
GST_END_TEST

GST_START_TEST(a_message_of_an_object_that_stands_begins_no_event) {
  Rig rig;
  rig.start();
  const auto tell = [&](CerberusRegionState state, guint32 number) {
    CerberusTrack track;
    cerberus_track_init(&track);
    track.state = CERBERUS_TRACK_APPEARED;
    track.region.state = state;
    const CerberusStamp stamp = stamp_at(number * kFrame);
    g_autoptr(GstMessage) message = cerberus_message_new_track(nullptr, &stamp, &track);
    g_signal_emit_by_name(rig.element, "handle-message", message);
  };
  rig.play_to(40);
  tell(CERBERUS_REGION_STOPPED, 40);
  rig.play_to(100);
  tell(CERBERUS_REGION_SEEN, 100);
  rig.play_to(300);
  rig.finish();
  fail_unless_equals_int(rig.folder.files().size(), 1);
  fail_unless(recorded(rig) == range(70, 110));
}
GST_END_TEST

GST_START_TEST(a_folder_that_is_missing_or_none_is_an_error_that_names_it) {
  for (const std::string location : {"/nonexistent-cerberus/recordings", "/dev/null"}) {
    Rig rig;
    g_object_set(rig.element, "location", location.c_str(), nullptr);
    fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
    g_autoptr(GstMessage) message = rig.take(GST_MESSAGE_ERROR);
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    fail_unless(g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_OPEN_WRITE));
    fail_unless(strstr(error->message, location.c_str()), "%s", error->message);
  }
}
GST_END_TEST

GST_START_TEST(a_pattern_that_leaves_the_folder_is_refused) {
  Rig rig;
  g_object_set(rig.element, "file-name", "../{event}", nullptr);
  fail_unless_equals_int(gst_element_set_state(rig.element, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
}
GST_END_TEST

GST_START_TEST(a_folder_that_vanishes_and_comes_back_costs_no_frame) {
  Rig rig;
  rig.start();
  rig.play_to(57);
  const std::string away = rig.folder.path() + "-away";
  std::filesystem::rename(rig.folder.path(), away);
  rig.start_event();
  g_autoptr(GstMessage) warning = rig.take(GST_MESSAGE_WARNING);
  g_autoptr(GError) error = nullptr;
  gst_message_parse_warning(warning, &error, nullptr);
  fail_unless(strstr(error->message, rig.folder.path().c_str()), "%s", error->message);
  g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  std::filesystem::rename(away, rig.folder.path());
  rig.play_to(57 + 130);  // the next file is tried after 5 s
  rig.finish();
  fail_unless(recorded(rig, "/1-2.mp4") == range(30, 57 + 130));
}
GST_END_TEST

// A limit of the process stands for the disk's end.
GST_START_TEST(a_full_disk_costs_a_warning_and_recording_goes_on_when_there_is_room) {
  Rig rig;
  rig.frame_size = 16 << 10;
  rig.start();
  rig.play_to(57);
  {
    const FileLimit limit(256 << 10);
    rig.start_event();
    rig.play_to(150);
    g_autoptr(GstMessage) warning = rig.take(GST_MESSAGE_WARNING);
    fail_unless(warning != nullptr);
    g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  }
  rig.play_to(400);
  rig.finish();
  const auto later = recorded(rig, "/1-2.mp4");
  fail_unless(!later.empty() && later.front() <= 290);  // 5 s and a GOP
  fail_unless(later == range(later.front(), 400));
}
GST_END_TEST

static Suite* eventrecorder_triggers_suite() {
  watch_library_log();
  Suite* suite = suite_create("eventrecorder triggers");
  TCase* tests = tcase_create("triggers and faults");
  tcase_add_loop_test(tests, a_track_on_the_analysis_pad_is_recorded_however_late_it_comes, 0, 2);
  tcase_add_test(tests, zones_of_the_world_follow_the_head);
  tcase_add_test(tests, an_object_that_stands_keeps_an_event_going_but_begins_none);
  tcase_add_test(tests, metadata_on_the_encoded_video_counts_without_an_analysis_pad);
  tcase_add_test(tests, messages_of_motion_begin_and_end_an_event);
  tcase_add_test(tests, a_message_of_an_object_that_stands_begins_no_event);
  tcase_add_test(tests, a_folder_that_is_missing_or_none_is_an_error_that_names_it);
  tcase_add_test(tests, a_pattern_that_leaves_the_folder_is_refused);
  tcase_add_test(tests, a_folder_that_vanishes_and_comes_back_costs_no_frame);
  tcase_add_test(tests, a_full_disk_costs_a_warning_and_recording_goes_on_when_there_is_room);
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(eventrecorder_triggers)
