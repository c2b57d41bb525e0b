// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/reckoning.h"

#include <chrono>

#include "support/suite.h"

using namespace cerberus::motion;
using namespace std::chrono_literals;

START_TEST(a_position_is_the_sum_of_the_speeds) {
  Reckoning head;
  head.begin(0s, {0.25, -0.5});
  head.turn(1s, {0.5, 0});
  head.turn(3s, {-1, 0.125});
  head.turn(4s, {});
  ck_assert_double_eq(head.at(0s).pan.position, 0.25);
  ck_assert_double_eq(head.at(2s).pan.position, 0.75);   // .25 + .5
  ck_assert_double_eq(head.at(3s).pan.position, 1.25);   // .25 + 2 x .5
  ck_assert_double_eq(head.at(10s).pan.position, 0.25);  // 1.25 - 1
  ck_assert_double_eq(head.at(10s).tilt.position, -0.375);
  ck_assert_double_eq(head.at(3500ms).pan.speed, -1);
}
END_TEST

START_TEST(a_piece_ends_where_the_speed_changes) {
  Reckoning head;
  head.begin(0s, {});
  head.turn(1s, {0.5, 0});
  head.turn(3s, {});
  ck_assert(head.at(0s).until == 1s);
  ck_assert(head.at(1s).until == 3s);
  ck_assert(head.at(1s).from == 1s);
  ck_assert(head.at(5s).until == kNever);
  ck_assert(!head.at(0s).settled);  // it is about to turn
  ck_assert(head.at(3s).settled);
}
END_TEST

START_TEST(an_earlier_speed_replaces_the_later_ones) {
  Reckoning head;
  head.begin(0s, {});
  head.turn(1s, {1, 0});
  head.turn(2s, {5, 0});
  head.turn(1500ms, {});
  ck_assert_double_eq(head.at(9s).pan.position, 0.5);
}
END_TEST

START_TEST(a_known_place_shifts_all_positions) {
  Reckoning head;
  head.begin(0s, {});
  head.turn(0s, {1, 0});
  head.place(2s, {2.5, 0.25});
  ck_assert_double_eq(head.at(2s).pan.position, 2.5);
  ck_assert_double_eq(head.at(3s).pan.position, 3.5);
  ck_assert_double_eq(head.at(1s).pan.position, 1.5);
  ck_assert_double_eq(head.at(3s).tilt.position, 0.25);
}
END_TEST

// .25 of play, the motor in its middle: the camera starts after .125, and after a reversal when .25 are taken up.
START_TEST(play_is_taken_up_before_the_camera_turns) {
  Reckoning head;
  head.set_play({0.25, 0});
  head.begin(0s, {});
  head.turn(0s, {0.5, 0});
  ck_assert_double_eq(head.at(200ms).pan.position, 0);
  ck_assert_double_eq(head.at(200ms).pan.speed, 0);
  ck_assert(!head.at(200ms).settled);
  ck_assert(head.at(0s).until == 250ms);
  ck_assert_double_eq(head.at(1s).pan.position, 0.375);
  ck_assert_double_eq(head.at(1s).pan.speed, 0.5);
  head.turn(1s, {-0.5, 0});
  ck_assert_double_eq(head.at(1400ms).pan.position, 0.375);
  ck_assert_double_eq_tol(head.at(2s).pan.position, 0.125, 1e-12);
}
END_TEST

// More changes than are kept: the present stays right.
START_TEST(a_thousand_changes_leave_no_error) {
  Reckoning head;
  head.begin(0s, {});
  for (int i = 0; i < 1000; ++i) head.turn(i * 1s, {i % 2 ? -0.5 : 0.5, 0});
  head.turn(1000s, {});
  ck_assert_double_eq(head.at(2000s).pan.position, 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "reckoning", {play_is_taken_up_before_the_camera_turns, a_position_is_the_sum_of_the_speeds,
                    a_piece_ends_where_the_speed_changes, an_earlier_speed_replaces_the_later_ones,
                    a_known_place_shifts_all_positions, a_thousand_changes_leave_no_error});
}
