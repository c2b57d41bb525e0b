// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames that are dropped upstream (videorate, a leaky queue): standing objects must still be found, and where that is
// impossible a warning must be posted.
#include "../support/motions.h"
#include "scene.h"
#include "support.h"
#include "vision/geometry/lens.h"

namespace {

using scene::Line;
using scene::Regions;
using scene::World;

// The corridor, cut in two behind each stage.
struct Cut {
  const char *before, *behind;
};
const Cut kCuts[] = {
    {"cameramotion",
     "threeframediff ! fuzzythreshold ! motionregions ! motiontrack confirm-time=0 ! identity"},
    {"cameramotion ! threeframediff",
     "fuzzythreshold ! motionregions ! motiontrack confirm-time=0 ! identity"},
    {"cameramotion ! threeframediff ! fuzzythreshold",
     "motionregions ! motiontrack confirm-time=0 ! identity"},
    {"cameramotion ! threeframediff ! fuzzythreshold ! motionregions",
     "motiontrack confirm-time=0 ! identity"},
};
const double kPans[] = {0, 5};  // pixels a frame
constexpr int kCutCount = G_N_ELEMENTS(kCuts), kPanCount = G_N_ELEMENTS(kPans);

World turning(double pan) {
  World world = scene::entering();
  world.speed = 3 + pan;  // in the picture: 3
  world.pan = pan;
  return world;
}

// Of three frames one comes through, marked as a leaky queue marks it, and with other times, as videorate writes them.
GST_START_TEST(frames_dropped_between_two_stages_do_not_stop_the_detection) {
  const Cut& cut = kCuts[__i__ % kCutCount];
  const World world = turning(kPans[__i__ / kCutCount]);
  Line before(std::string(cut.before) + " ! identity"), behind(cut.behind);
  int seen = 0;
  guint id = 0;
  for (int k = 0; k < 90; ++k) {
    GstBuffer* out = before.through(scene::grey_buffer(world, k));
    if (k % 3 != 0) {
      gst_buffer_unref(out);
      continue;
    }
    GST_BUFFER_FLAG_SET(out, GST_BUFFER_FLAG_DISCONT);
    GST_BUFFER_PTS(out) += 7 * GST_MSECOND;
    out = behind.through(out);
    const Regions regions(out);
    for (guint i = 0; i < regions.size(); ++i)
      fail_unless(scene::overlaps_figure(regions[i], world, k), "frame %d: a wrong region: %s", k,
                  regions.text().c_str());
    if (regions.size() > 0) {
      fail_unless(id == 0 || regions[0].id == id, "frame %d: another identity", k);
      id = regions[0].id;
      ++seen;
    }
    gst_buffer_unref(out);
  }
  fail_unless(seen >= 18, "seen in %d frames of 23", seen);  // inside from frame 20 on
  fail_unless(behind.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

// The difference to the frame that was seen before, not to the one that was dropped: the wall stands in it.
GST_START_TEST(the_camera_is_followed_across_a_dropped_frame) {
  const World world = turning(5);
  Line camera("cameramotion"), difference("threeframediff");
  for (int k = 0; k < 40; ++k) {
    GstBuffer* out = camera.through(scene::grey_buffer(world, k));
    if (k == 32) {
      gst_buffer_unref(out);
      continue;
    }
    // Without its path, as an application that writes the motion itself may leave it, a motion from another frame is
    // not believed.
    if (__i__ == 1) {
      CerberusCameraMotion motion = *cerberus_buffer_peek_camera_motion(out);
      motion.path_id = 0;
      cerberus_buffer_set_camera_motion(out, &motion);
    }
    out = difference.through(out);
    const cerberus::vision::Record record = records::record_of(out);
    const cerberus::vision::GrayView plane = record->differences->current->view();
    int different = 0;
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x) different += plane.at(x, y) > 20;
    gst_buffer_unref(out);
    if (k == 33 && __i__ == 1)
      fail_unless(different == 0, "frame %d: %d", k, different);
    else if (k >= 31)
      fail_unless(different > 0 && different < scene::kWidth * scene::kHeight / 10, "frame %d: %d", k,
                  different);
  }
}
GST_END_TEST

// Two cameras and a selector: the second one's path is not the first one's, however alike they look.
GST_START_TEST(the_path_of_another_camera_is_not_followed) {
  const World first, second = [] {
    World world;
    world.wall = 5;
    return world;
  }();
  Line one("cameramotion"), two("cameramotion"), behind("motionregions ! identity");
  for (int k = 0; k < 20; ++k) {
    GstBuffer* a = one.through(scene::grey_buffer(first, k));
    GstBuffer* b = two.through(scene::grey_buffer(second, k));
    gst_buffer_unref(k < 10 ? b : a);
    GstBuffer* out = behind.through(k < 10 ? a : b);
    if (k == 10) {
      fail_unless_equals_int(Regions(out).size(), 0);
      fail_if(records::threshold_facts_of(out)->result.ready);
    }
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// A leaky queue in front: holes, each of them marked.
GST_START_TEST(frames_dropped_in_front_do_not_stop_the_detection) {
  const World world = turning(kPans[__i__]);
  Line line("motiondetect confirm-time=0");
  int seen = 0;
  for (int k = 0; k < 80; k += 2) {
    GstBuffer* in = scene::grey_buffer(world, k);
    GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT);
    GstBuffer* out = line.through(in);
    seen += Regions(out).size() > 0;
    gst_buffer_unref(out);
  }
  fail_unless(seen >= 20, "seen in %d frames of 30", seen);
  fail_unless(line.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

// Marked without a gap: each of these frames is a cut, as far as the element can see. One message explains why nothing
// is found, also where each scene ends just before the first confirmation: the third frame has the first regions,
// three are needed, and confirm-time. There is no message where the scenes are a little longer: an occasional seek is
// usual.
GST_START_TEST(a_stream_of_breaks_is_complained_of_once) {
  const struct {
    int fps, every;
    bool warned;
  } kCases[] = {{25, 1, true}, {25, 3, true}, {25, 7, true}, {25, 8, false}, {5, 4, true},   {5, 5, false},
                {2, 4, true},  {2, 5, false}, {60, 9, true}, {60, 14, true}, {60, 15, false}};
  const auto& [fps, every, warned] = kCases[__i__];
  const World world;
  const std::string rate = ",framerate=" + std::to_string(fps) + "/1";
  Line line("motiondetect", scene::caps("GRAY8", scene::kWidth, scene::kHeight, rate.c_str()));
  for (int k = 0; k < 15 * every; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k % 80);
    GST_BUFFER_PTS(in) = k * GST_SECOND / fps;
    if (k % every == 0) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT);
    gst_buffer_unref(line.through(in));
  }
  const auto warnings = line.messages(GST_MESSAGE_WARNING);
  fail_unless_equals_int(warnings.size(), warned);
  if (warned) fail_unless(warnings[0].find("videorate") != std::string::npos, "%s", warnings[0].c_str());
}
GST_END_TEST

// Camera motion of another element, which is connected by its times only, and dropped frames; and an occasional seek,
// for which no warning is posted.
GST_START_TEST(motions_that_cannot_be_followed_are_complained_of_once) {
  const World world;
  Line stage("threeframediff"), sought("threeframediff");
  for (int k = 0; k < 60; ++k) {
    GstBuffer* in = scene::grey_buffer(world, k);
    CerberusCameraMotion motion;
    cerberus_camera_motion_init(&motion);
    motion.from = (k - 1) * scene::kStep;
    motion.scene_age = k + 2;
    cerberus_buffer_set_camera_motion(in, &motion);
    if (k % 2 == 0) gst_buffer_unref(stage.through(gst_buffer_copy(in)));
    if (k % 10 == 0) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_DISCONT);
    gst_buffer_unref(sought.through(in));
  }
  fail_unless_equals_int(stage.messages(GST_MESSAGE_WARNING).size(), 1);
  fail_unless(sought.messages(GST_MESSAGE_WARNING).empty());
}
GST_END_TEST

Suite* dropped_frames_suite() {
  Suite* suite = suite_create("dropped frames");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_loop_test(tests, frames_dropped_between_two_stages_do_not_stop_the_detection, 0,
                      kCutCount * kPanCount);
  tcase_add_loop_test(tests, the_camera_is_followed_across_a_dropped_frame, 0, 2);
  tcase_add_test(tests, the_path_of_another_camera_is_not_followed);
  tcase_add_loop_test(tests, frames_dropped_in_front_do_not_stop_the_detection, 0, kPanCount);
  tcase_add_loop_test(tests, a_stream_of_breaks_is_complained_of_once, 0, 11);
  tcase_add_test(tests, motions_that_cannot_be_followed_are_complained_of_once);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(dropped_frames);
