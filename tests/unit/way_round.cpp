// SPDX-License-Identifier: LGPL-2.1-or-later
// A head of +-170 degrees, 90 a second, with a lens of 60: a target counts as in the picture within 24 degrees.
#include "control/following/way_round.h"

#include <check.h>

#include <cmath>

#include "support/suite.h"

using namespace cerberus::control;
using cerberus::motion::AxisCommand;
using cerberus::motion::AxisLimits;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

AxisLimits limits_of(double range, double speed = 90) {
  return {radians(-range), radians(range), radians(speed), radians(600)};
}
const AxisLimits kLimits = limits_of(170);

// All in degrees; the side is 1 or -1.
WayRound::Situation at(double side, double target, double rate, double head = 170, double effect = 10) {
  return {radians(side * target), radians(side * rate), radians(side * head), radians(60), effect, .1};
}

double goal(WayRound& way, double effect, double head, const AxisLimits& limits = kLimits) {
  const auto command = way.command(effect, radians(head), limits);
  ck_assert(command && command->kind == AxisCommand::Kind::position);
  ck_assert_double_eq_tol(command->speed, limits.speed, 1e-9);
  return degrees(command->value);
}

}  // namespace

START_TEST(the_head_waits_while_the_target_is_in_view_from_the_stop_and_goes_when_it_leaves) {
  for (const double side : {1., -1.}) {
    WayRound way;
    // In .3 s it is at 193, and 194 is in view.
    ck_assert(!way.decide(at(side, 185, 27), kLimits));
    ck_assert(!way.active() && !way.command(10, side * radians(170), kLimits));
    // 200: it leaves, and is met 2.95 s later on the other side: (170 - 24 + 168) / 117 + .075 + .1 s.
    ck_assert(way.decide(at(side, 192, 27), kLimits));
    ck_assert(way.active());
    // A target that stands out of view is where it is, however long the head waits: nothing is predicted to come.
    WayRound other;
    ck_assert(!other.decide(at(side, 190, 0), kLimits));
  }
}
END_TEST

START_TEST(a_target_that_comes_back_is_waited_for) {
  WayRound way;
  ck_assert(!way.decide(at(1, 200, -10), kLimits));  // in view after .6 s
  // 230 at -10: in view after 3.6 s; round: -130 is 276 away at 80 a second: 3.45 s and .175.
  ck_assert(!way.decide(at(1, 230, -10), kLimits));
  ck_assert(way.decide(at(1, 235, -10), kLimits));
}
END_TEST

START_TEST(a_way_that_takes_too_long_is_not_gone) {
  WayRound way;
  ck_assert(way.decide(at(1, 195, 27), limits_of(170, 20)));  // 311 / 47 = 6.6 s
  way.end();
  ck_assert(!way.decide(at(1, 195, 27), limits_of(170, 10)));  // 311 / 37 = 8.4 s
}
END_TEST

START_TEST(the_blind_sector_of_narrow_limits_must_be_crossed_in_time) {
  WayRound way;
  // -246 is in view from -90 at -114: 132 degrees at 27, and at 10.
  ck_assert(way.decide(at(1, 114, 27, 90), limits_of(90)));
  way.end();
  ck_assert(!way.decide(at(1, 114, 10, 90), limits_of(90)));
}
END_TEST

START_TEST(it_goes_to_where_the_target_is_predicted_and_then_to_the_other_stop) {
  for (const double side : {1., -1.}) {
    WayRound way;
    ck_assert(way.decide(at(side, 195, 20), kLimits));
    ck_assert_double_eq_tol(goal(way, 10, side * 170), side * -165, 1e-9);
    ck_assert_double_eq_tol(goal(way, 11, side * 90), side * -145, 1e-9);
    ck_assert_double_eq_tol(goal(way, 12.5, side * -100), side * -115, 1e-9);
    // Passed, and nobody was there.
    ck_assert_double_eq_tol(goal(way, 13, side * -112), side * -170, 1e-9);
    ck_assert_double_eq_tol(goal(way, 13.1, side * -120), side * -170, 1e-9);
    // Met after 2.98 s by the plan, and 1.5 s later.
    ck_assert(way.command(14.4, side * radians(-170), kLimits));
    ck_assert(!way.command(14.6, side * radians(-170), kLimits));
    ck_assert(!way.active());
  }
}
END_TEST

START_TEST(it_turns_back_only_for_a_target_that_is_met_much_sooner_there) {
  WayRound way;
  ck_assert(way.decide(at(1, 195, 27), kLimits));
  ck_assert(way.decide(at(1, 196, 20, 160, 10.1), kLimits));  // still in the picture: it goes on
  ck_assert(!way.decide(at(1, 196, -20, 160, 10.2), kLimits));
  ck_assert(!way.active());
}
END_TEST

START_TEST(a_target_on_the_other_side_is_not_the_one_left_behind) {
  WayRound way;
  ck_assert(way.decide(at(1, 195, 27), kLimits));
  ck_assert(way.leaves_behind(radians(197), kLimits));
  ck_assert(!way.leaves_behind(radians(150), kLimits));
  ck_assert(!way.leaves_behind(radians(-175), kLimits));
}
END_TEST

START_TEST(of_an_unknown_lens_a_small_view_is_believed_in) {
  WayRound::Situation now = at(1, 185, 27);
  now.view = 0;  // 20 degrees: 193 is out of view
  WayRound way;
  ck_assert(way.decide(now, kLimits));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "way_round", {the_head_waits_while_the_target_is_in_view_from_the_stop_and_goes_when_it_leaves,
                    a_target_that_comes_back_is_waited_for, a_way_that_takes_too_long_is_not_gone,
                    the_blind_sector_of_narrow_limits_must_be_crossed_in_time,
                    it_goes_to_where_the_target_is_predicted_and_then_to_the_other_stop,
                    it_turns_back_only_for_a_target_that_is_met_much_sooner_there,
                    a_target_on_the_other_side_is_not_the_one_left_behind,
                    of_an_unknown_lens_a_small_view_is_believed_in});
}
