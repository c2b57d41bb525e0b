// SPDX-License-Identifier: LGPL-2.1-or-later
// Poses, their history, and the watchdog.
#include "motion/pose.h"

#include <check.h>

#include "../support/suite.h"
#include "control/watchdog.h"

using namespace cerberus::control;
using namespace cerberus::motion;
using namespace std::chrono_literals;

namespace {

Pose piece(Time from, Time until, double position, double speed, double acceleration = 0) {
  Pose pose;
  pose.from = from;
  pose.until = until;
  pose.pan = {position, speed, acceleration};
  pose.tilt = {-position, 0, 0};
  return pose;
}

}  // namespace

// 1 + 2 t + 3 t^2 / 2 at t = 0.5 is 2.375, the speed 3.5.
START_TEST(a_pose_moves_on_with_its_acceleration) {
  const Pose later = piece(1s, 2s, 1, 2, 3).at(1500ms);
  ck_assert_double_eq_tol(later.pan.position, 2.375, 1e-12);
  ck_assert_double_eq_tol(later.pan.speed, 3.5, 1e-12);
  ck_assert_double_eq_tol(later.tilt.position, -1, 1e-12);
  ck_assert(later.moving());
}
END_TEST

START_TEST(a_pose_is_held_at_its_ends) {
  const Pose pose = piece(1s, 2s, 1, 2);
  ck_assert_double_eq_tol(pose.at(0s).pan.position, 1, 1e-12);
  ck_assert_double_eq_tol(pose.at(9s).pan.position, 3, 1e-12);
}
END_TEST

START_TEST(a_frame_gets_the_pose_of_its_own_time_not_the_latest) {
  PoseHistory history;
  ck_assert_double_eq(history.at(5s).pan.position, 0);
  history.add(piece(1s, 2s, 0, 1));
  history.add(piece(2s, 3s, 1, 10));
  ck_assert_double_eq_tol(history.at(1500ms).pan.position, 0.5, 1e-12);
  ck_assert_double_eq_tol(history.at(2500ms).pan.position, 6, 1e-12);
  ck_assert_double_eq_tol(history.at(0s).pan.position, 0, 1e-12);    // before the first
  ck_assert_double_eq_tol(history.at(60s).pan.position, 11, 1e-12);  // after the last
}
END_TEST

START_TEST(a_newer_plan_replaces_what_was_to_come) {
  PoseHistory history;
  history.add(piece(1s, 2s, 0, 1));
  history.add(piece(2s, 3s, 1, 1));
  history.add(piece(3s, kNever, 2, 0));
  history.add(piece(1500ms, kNever, 0.5, 0));
  ck_assert_double_eq_tol(history.at(1400ms).pan.position, 0.4, 1e-12);
  ck_assert_double_eq_tol(history.at(9s).pan.position, 0.5, 1e-12);
}
END_TEST

START_TEST(only_the_oldest_poses_are_forgotten) {
  PoseHistory history;
  for (int k = 0; k < 1000; ++k) history.add(piece(k * 20ms, (k + 1) * 20ms, k, 0));
  ck_assert_double_eq(history.at(999 * 20ms).pan.position, 999);
  ck_assert_double_eq(history.at((1000 - 256) * 20ms).pan.position, 1000 - 256);
  ck_assert_double_eq(history.at(0s).pan.position, 1000 - 256);  // the oldest that is left
}
END_TEST

START_TEST(the_watchdog_bites_once_without_input) {
  Watchdog dog;
  dog.set_timeout(500ms);
  ck_assert(!dog.bites(99s));  // no input is expected
  dog.feed(1s);
  ck_assert_int_eq(dog.deadline().count(), Time(1500ms).count());
  ck_assert(!dog.bites(1499ms));
  dog.feed(1400ms);
  ck_assert(!dog.bites(1899ms));
  ck_assert(dog.bites(1900ms));
  ck_assert(!dog.bites(1901ms));
  dog.feed(5s);
  dog.rest();
  ck_assert(!dog.bites(99s));
}
END_TEST

START_TEST(a_watchdog_without_a_timeout_sleeps) {
  Watchdog dog;
  dog.feed(1s);
  ck_assert(dog.deadline() == kNever);
  ck_assert(!dog.bites(kNever));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "pose_history", {a_pose_moves_on_with_its_acceleration, a_pose_is_held_at_its_ends,
                       a_frame_gets_the_pose_of_its_own_time_not_the_latest,
                       a_newer_plan_replaces_what_was_to_come, only_the_oldest_poses_are_forgotten,
                       the_watchdog_bites_once_without_input, a_watchdog_without_a_timeout_sleeps});
}
