// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink whose head reports no position, on a base that turns: frames say how the picture moved, and its helper is a
// shell that reads to the end of its input.
#include <algorithm>
#include <string>
#include <utility>

#include "../support/says.h"
#include "head_rig.h"

namespace {

using namespace head_rig;

// A lens of 60 degrees: F = 160 / tan 30. A shift of s pixels is a mean angle of .9069 s / F over the picture.
constexpr double kPixels = 160 / .57735 / .9069 * std::numbers::pi / 180;  // a degree

// The picture has turned by `turn` degrees since the frame at `from`, and by `pan` since the first one.
void set_motion(GstBuffer* buffer, GstClockTime from, guint age, double turn, double pan) {
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.confidence = 1;
  motion.from = from;
  motion.scene_age = age;
  motion.path_id = 1;
  for (const int i : {0, 4, 8}) motion.matrix[i] = motion.path[i] = 1;
  motion.matrix[2] = -turn * kPixels;
  motion.path[2] = -pan * kPixels;
  cerberus_buffer_set_camera_motion(buffer, &motion);
}

// A base that turns at 45 degrees a second, and the camera on it.
struct Base {
  Rig& rig;
  double pan = 0;  // of the base, degrees
  GstClockTime last = 0;
  guint frames = 0;

  // The picture since the frame before, of a head that stands.
  GstBuffer* frame(GstClockTime now) {
    const double turn = 45 * static_cast<double>(now - last) / GST_SECOND;
    pan += turn;
    GstBuffer* buffer = frame_with(CERBERUS_FUSION_HOLD, now);
    set_motion(buffer, std::exchange(last, now), ++frames, turn, pan);
    return buffer;
  }
  // Turns on by so many degrees, with a frame each time when the head is to be looked after, and 40 ms later at the
  // least; `act` before each. Returns the largest pan that is published, degrees of either sign.
  template <typename Act>
  double turn(double degrees, Act act) {
    double most = 0;
    for (const double end = pan + degrees; pan < end;) {
      const GstClockTime now = rig.crank();
      for (const CerberusPose& pose : rig.poses()) most = std::max(most, std::abs(pose.pan));
      if (now < last + kFrame) continue;
      act();
      rig.push(frame(now));
    }
    return most;
  }
};

std::string blind_head() {
  return "horizontal-fov=60 watchdog-timeout=0 driver=external head=" + new_head() +
         " command=\"sh -c 'echo ready 1 velocity; exec cat >/dev/null'\"";
}

}  // namespace

GST_START_TEST(the_turn_of_the_base_is_not_the_heads) {
  Rig rig(blind_head(), Source::live);
  rig.push(frame_at(0));
  const double most = Base{rig}.turn(90, [] {});
  fail_unless(most < .01, "%g", most);
  const std::string warnings = rig.warnings();
  fail_unless(warnings.empty(), "%s", warnings.c_str());
}
GST_END_TEST

// The head turns at 10 degrees a second for 2 s, while the base turns by 90 degrees.
GST_START_TEST(a_gyro_that_is_missing_is_said_once) {
  Rig rig(blind_head(), Source::live);
  rig.push(frame_at(0));
  Base base{rig};
  base.turn(45, [] {});
  fail_unless(rig.warnings().empty());
  const double most = base.turn(90, [&] { fail_unless(rig.call("turn", -10, 0)); });
  fail_unless(most > 15 && most < 21, "%g", most);
  const std::string warnings = rig.warnings();
  fail_unless(says(warnings, "a gyro is missing"));
  base.turn(45, [&] { fail_unless(rig.call("turn", 10, 0)); });
  fail_unless(rig.warnings().find("gyro") == std::string::npos);
}
GST_END_TEST

// It says no number, as it may of a robot whose turn is not known.
GST_START_TEST(a_base_whose_rate_is_no_number_leaves_the_head_its_target) {
  Rig rig("horizontal-fov=60");
  double pan = 0;
  for (guint k = 0; k < 75; ++k) {
    GstBuffer* buffer = frame_at(k * kFrame);
    set_motion(buffer, k > 0 ? (k - 1) * kFrame : 0, k + 1, 0, 0);
    CerberusBase rate;
    cerberus_base_init(&rate);
    rate.source = CERBERUS_BASE_REPORTED;
    rate.yaw_rate = NAN;
    cerberus_buffer_set_base(buffer, &rate);
    add(buffer, CERBERUS_FUSION_TRACK, 7);
    add(buffer, person(7, 25 - pan));
    rig.push(buffer);
    for (const CerberusPose& pose : rig.poses())
      cerberus_pose_evaluate(&pose, (k + 1) * kFrame, &pan, nullptr);
  }
  fail_unless(std::fabs(pan - 25) < 1, "%g", pan);
}
GST_END_TEST

static Suite* pantiltsink_base_suite() {
  Suite* suite = suite_create("pantiltsink on a base that turns");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, the_turn_of_the_base_is_not_the_heads);
  tcase_add_test(tests, a_gyro_that_is_missing_is_said_once);
  tcase_add_test(tests, a_base_whose_rate_is_no_number_leaves_the_head_its_target);
  return suite;
}

GST_CHECK_MAIN(pantiltsink_base)
