// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/search/seen_around.h"

#include <check.h>

#include <limits>

#include "sensing/angles.h"
#include "support/suite.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::Interval;
using cerberus::sensing::radians;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Interval between(double from, double to) {
  return {radians(from), radians(to)};
}

Time age(const SeenAround& around, double from, double to) {
  return around.unseen(between(from, to), 3s).age;
}

// Of what lies between the first two, the part that was not seen for 3 s.
void assert_part(const SeenAround& around, double from, double to, double first, double last) {
  const Interval part = around.unseen(between(from, to), 3s).part;
  ck_assert_double_eq_tol(degrees(part.from), first, 1e-6);
  ck_assert_double_eq_tol(degrees(part.to), last, 1e-6);
}

void see(SeenAround& around, Time time, double pan, double rate = 0) {
  around.see(time, radians(pan), radians(60), radians(rate));
}

}  // namespace

START_TEST(before_the_first_picture_everything_is_forgotten) {
  SeenAround around;
  see(around, 100s, 180);
  ck_assert(age(around, -30, 30) == SeenAround::kForgotten);
  ck_assert(age(around, 60, 120) == SeenAround::kForgotten);
}
END_TEST

START_TEST(a_picture_makes_its_directions_new_and_no_others) {
  SeenAround around;
  see(around, 1s, 0);
  ck_assert(age(around, -30, 30) == 0s);
  ck_assert(age(around, 30, 90) == SeenAround::kForgotten);
  ck_assert(age(around, 0, 60) == SeenAround::kForgotten / 2);
  see(around, 3s, 180);
  ck_assert(age(around, -30, 30) == 2s);
  ck_assert(age(around, 150, 170) == 0s);  // the circle closes
  ck_assert(age(around, -170, -150) == 0s);
  see(around, 9s, 90);
  ck_assert(age(around, -30, 30) == SeenAround::kForgotten);
}
END_TEST

START_TEST(the_unseen_part_lies_between_its_first_and_its_last_direction) {
  SeenAround around;
  see(around, 1s, 0);
  assert_part(around, -60, 60, -60, 60);  // both sides of the picture
  assert_part(around, -30, 60, 30, 60);
  assert_part(around, -100, 0, -100, -30);
  ck_assert(around.unseen(between(-30, 30), 3s).part.width() < 0);
  see(around, 4s, 60);
  assert_part(around, -30, 60, -30, 30);
  assert_part(around, 14, 16, 14, 16);  // narrower than a cell
}
END_TEST

// Since 5 s before zero, as far as is known.
START_TEST(a_direction_that_was_missed_for_long_makes_its_place_old) {
  SeenAround around;
  for (Time now = 1s; now <= 10s; now += 1s) see(around, now, 0);
  ck_assert(age(around, -30, 40) < 2s);
  for (Time now = 11s; now <= 12s; now += 1s) see(around, now, 0);
  ck_assert(age(around, -30, 40) == SeenAround::kForgotten);
  ck_assert(age(around, -30, 30) == 0s);
}
END_TEST

// What was ahead is to the left after a quarter turn to the right.
START_TEST(a_body_that_turns_sees_with_a_head_that_stands) {
  SeenAround around;
  Time now = 1s;
  see(around, now, 0);
  for (int i = 0; i < 20; ++i) see(around, now += 100ms, 0, 45);
  ck_assert(age(around, -30, 30) == 0s);
  const Time left = age(around, -120, -60);
  ck_assert(left > 700ms && left < 2s);  // it left the picture bit by bit
  ck_assert(age(around, 60, 120) == SeenAround::kForgotten);
}
END_TEST

START_TEST(an_unknown_pan_sees_nothing_and_an_unknown_rate_is_no_turn) {
  SeenAround around;
  see(around, 1s, kNan);
  ck_assert(age(around, -30, 30) == SeenAround::kForgotten);
  see(around, 2s, 0, kNan);
  see(around, 3s, 90, kNan);
  ck_assert(age(around, -30, 30) == 1s);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "seen_around",
      {before_the_first_picture_everything_is_forgotten, a_picture_makes_its_directions_new_and_no_others,
       the_unseen_part_lies_between_its_first_and_its_last_direction,
       a_direction_that_was_missed_for_long_makes_its_place_old,
       a_body_that_turns_sees_with_a_head_that_stands,
       an_unknown_pan_sees_nothing_and_an_unknown_rate_is_no_turn});
}
