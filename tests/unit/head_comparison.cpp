// SPDX-License-Identifier: LGPL-2.1-or-later
// Frames every 40 ms, seen through a lens of 60 degrees; angles in degrees.
#include "control/head_comparison.h"

#include <check.h>

#include <cmath>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::control;
using namespace std::chrono_literals;
using sensing::degrees;
using sensing::radians;

namespace {

constexpr vision::Size kSize{320, 240};
const vision::Lens kLens(radians(60), kSize), kNoLens(0, kSize);
constexpr double kSeconds = .04;
constexpr char kName[] = "head", kOther[] = "other";

// One camera on one head on one base.
struct Scene {
  HeadComparison comparison;
  double head = 0, camera = 0;  // where the head was sent, and where the camera looks
  motion::Time now{};
  double rate = 0;  // of the base, a second
  int pan_faults = 0, tilt_faults = 0;
  SlipFault fault = SlipFault::none;
  bool commanded = true;
  const char* name = kName;
  double confidence = 1, reported = 0;

  // The head is sent on by `turn`, and the camera turns by `seen`.
  std::optional<vision::Transform> frame(double turn, double seen, const vision::Lens& lens = kLens) {
    const double before = camera;
    head += turn;
    camera += seen;
    now += 40ms;
    const auto expected = comparison.expect({motion::PanTilt{radians(head), 0}, name, commanded}, lens);
    const vision::Transform motion = kLens.turn(radians(before), 0, radians(camera), 0);
    rate = degrees(comparison.base_rate({kSize, motion, confidence, now, kSeconds, false}, lens));
    const auto [pan, tilt] = comparison.faults(kSeconds, radians(reported));
    pan_faults += pan.has_value();
    tilt_faults += tilt.has_value();
    if (pan) fault = pan->fault;
    return expected;
  }
  // The head goes to and fro, 40 degrees a second, one second each way; the camera turns by `gain` times that.
  void sweep(int frames, double gain) {
    for (int k = 0; k < frames; ++k) {
      const double turn = k / 25 % 2 ? -1.6 : 1.6;
      frame(turn, gain * turn);
    }
  }
};

}  // namespace

START_TEST(what_the_head_does_not_explain_is_the_base) {
  Scene still, follows, both;
  for (int k = 0; k < 25; ++k) {
    still.frame(0, .5);     // the head stands, the picture turns by .5 degrees in .04 s
    follows.frame(.5, .5);  // the head alone
    both.frame(-.5, .25);   // the base turns by .75
  }
  ck_assert_double_eq_tol(still.rate, 12.5, .01);
  ck_assert_double_eq_tol(follows.rate, 0, .01);
  ck_assert_double_eq_tol(both.rate, 18.75, .01);
}
END_TEST

START_TEST(the_picture_is_expected_to_move_as_the_head_turned) {
  Scene scene;
  ck_assert(!scene.frame(0, 0));  // of the first frame
  const auto expected = scene.frame(3, 3);
  ck_assert(expected.has_value());
  // The axis moves to the left by F tan 3 degrees, F = 160 / tan 30 degrees = 277.13 pixels: 14.52.
  const auto axis = expected->apply({160, 120});
  ck_assert_double_eq_tol(axis.x, 160 - 14.52, .01);
  ck_assert_double_eq_tol(axis.y, 120, .01);
  ck_assert(!scene.frame(3, 3, kNoLens));
  ck_assert(!scene.comparison.expect({}, kLens));
}
END_TEST

START_TEST(an_uncertain_picture_or_an_unknown_lens_shows_no_base) {
  Scene uncertain, certain, unknown;
  uncertain.confidence = .49;
  certain.confidence = .5;
  for (int k = 0; k < 25; ++k) {
    uncertain.frame(0, .5);
    certain.frame(0, .5);
    unknown.frame(0, .5, kNoLens);
  }
  ck_assert(std::isnan(uncertain.rate));
  ck_assert(!std::isnan(certain.rate));
  ck_assert(std::isnan(unknown.rate));
}
END_TEST

START_TEST(a_head_of_unknown_direction_shows_no_base) {
  Scene scene;
  for (int k = 0; k < 25; ++k) scene.frame(0, .5);
  scene.head = NAN;
  for (int k = 0; k < 25; ++k) scene.frame(0, .5);
  ck_assert(std::isnan(scene.rate));
}
END_TEST

START_TEST(a_new_scene_forgets_the_base_and_a_repeated_frame_does_not) {
  Scene scene;
  for (int k = 0; k < 25; ++k) scene.frame(0, .5);
  ck_assert_double_eq_tol(degrees(scene.comparison.base_rate(scene.now + 100ms)), 12.5, .01);
  ck_assert(std::isnan(scene.comparison.base_rate({kSize, {}, 0, scene.now, 0, true}, kLens)));
}
END_TEST

START_TEST(a_head_that_does_not_turn_is_a_fault_once) {
  Scene good, bad;
  good.sweep(220, 1);
  bad.sweep(220, 0);
  ck_assert_int_eq(good.pan_faults, 0);
  ck_assert_int_eq(bad.pan_faults, 1);
  ck_assert(bad.fault == SlipFault::slips);
  ck_assert_int_eq(bad.tilt_faults, 0);
  ck_assert(std::isnan(bad.rate));  // what it really does is not known
}
END_TEST

START_TEST(only_commands_to_one_head_are_evidence_of_a_fault) {
  Scene measured, changing;
  measured.commanded = false;
  measured.sweep(220, 0);
  ck_assert_int_eq(measured.pan_faults, 0);
  for (int k = 0; k < 220; ++k) {
    changing.name = k % 2 ? kName : kOther;
    changing.frame(k / 25 % 2 ? -1.6 : 1.6, 0);
  }
  ck_assert_int_eq(changing.pan_faults, 0);
}
END_TEST

// The base turns against the head at each moment, so that the picture stands, and something else measures that.
START_TEST(a_base_that_was_measured_otherwise_is_no_fault_of_the_head) {
  Scene scene;
  for (int k = 0; k < 220; ++k) {
    const double turn = k / 25 % 2 ? -1.6 : 1.6;
    scene.reported = -turn / kSeconds;
    scene.frame(turn, 0);
  }
  ck_assert_int_eq(scene.pan_faults, 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "head_comparison",
      {what_the_head_does_not_explain_is_the_base, the_picture_is_expected_to_move_as_the_head_turned,
       an_uncertain_picture_or_an_unknown_lens_shows_no_base, a_head_of_unknown_direction_shows_no_base,
       a_new_scene_forgets_the_base_and_a_repeated_frame_does_not, a_head_that_does_not_turn_is_a_fault_once,
       only_commands_to_one_head_are_evidence_of_a_fault,
       a_base_that_was_measured_otherwise_is_no_fault_of_the_head});
}
