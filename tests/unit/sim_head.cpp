// SPDX-License-Identifier: LGPL-2.1-or-later
// The simulated pan axis against ways worked out by hand.
#include "sim/pan_head.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "sim/head_kinds.h"
#include "support/suite.h"

using namespace cerberus::sim;
using namespace std::chrono_literals;
using cerberus::motion::AxisCommand;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using Kind = AxisCommand::Kind;

namespace {

AxisCommand to(double position, double speed = 90) {
  return {Kind::position, radians(position), radians(speed)};
}
AxisCommand at(double speed) {
  return {Kind::velocity, radians(speed), 0};
}

// The motor's angle in each millisecond, degrees, with a random command every 30 ms.
std::vector<double> way(const HeadTraits& traits, unsigned seed) {
  PanHead head(traits, seed);
  std::mt19937 random(5);
  std::uniform_real_distribution<> speed(-120, 120);
  std::vector<double> angles;
  for (Time now{}; now < 10s; now += 1ms) {
    head.elapse(now);
    if (now % 30ms == 0ms) head.command(at(speed(random)), now);
    angles.push_back(degrees(head.motor()));
  }
  return angles;
}

}  // namespace

START_TEST(a_command_takes_effect_after_the_dead_time) {
  HeadTraits traits;
  traits.dead_time = .25;
  PanHead head(traits, 1);
  head.command(at(10), 1s);
  head.elapse(1249ms);
  ck_assert_double_eq(head.motor(), 0);
  head.elapse(1260ms);
  ck_assert_double_gt(head.motor(), 0);
}
END_TEST

START_TEST(a_dead_time_varies_within_its_jitter_and_keeps_the_order_of_commands) {
  HeadTraits traits;
  traits.dead_time = .2;
  traits.jitter = .05;
  double least = 1, most = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    PanHead head(traits, seed);
    head.command(at(10), Time{});
    Time now{};
    while (head.motor() == 0) head.elapse(now += 1ms);
    least = std::min(least, cerberus::motion::seconds(now));
    most = std::max(most, cerberus::motion::seconds(now));
  }
  // The motor has moved at the end of the millisecond in which the command took effect.
  ck_assert_double_ge(least, .15);
  ck_assert_double_le(least, .16);
  ck_assert_double_le(most, .252);
  ck_assert_double_ge(most, .24);
  PanHead head(traits, 3);
  for (Time now{}; now < 1s; now += 1ms) {
    head.command(now < 500ms ? at(90) : at(0), now);
    head.elapse(now);
  }
  head.elapse(2s);
  ck_assert_double_eq(head.speed(), 0);  // the last command is the last that takes effect
}
END_TEST

START_TEST(speed_and_acceleration_keep_their_limits) {
  const HeadTraits traits;
  const std::vector<double> angles = way(traits, 1);
  double fastest = 0, hardest = 0, before = 0;
  for (std::size_t k = 1; k < angles.size(); ++k) {
    const double speed = (angles[k] - angles[k - 1]) * 1000;
    fastest = std::max(fastest, std::abs(speed));
    hardest = std::max(hardest, std::abs(speed - before) * 1000);
    before = speed;
  }
  ck_assert_double_le(fastest, 90 + 1e-6);
  ck_assert_double_le(hardest, 300 + 1e-3);
  ck_assert_double_ge(hardest, 299);  // it uses what it has
}
END_TEST

START_TEST(it_brakes_in_time_and_rests_where_it_was_sent) {
  PanHead head({}, 1);
  head.command(to(40), Time{});
  double farthest = 0;
  for (Time now{}; now < 2s; now += 1ms) {
    head.elapse(now);
    farthest = std::max(farthest, degrees(head.motor()));
  }
  ck_assert_double_eq_tol(degrees(head.motor()), 40, .01);
  ck_assert_double_le(farthest, 40.1);
  ck_assert_double_eq_tol(degrees(head.speed()), 0, .5);
}
END_TEST

// 24 speeds up to 100: 51 is the 12th, 50, and 120 x (1/2)^2 = 30 is what the head makes of it.
START_TEST(a_table_of_speeds_is_neither_even_nor_fine) {
  HeadTraits traits;
  traits.speed = radians(100);
  traits.speeds = 24;
  traits.table_scale = 1.2;
  traits.table_exponent = 2;
  PanHead head(traits, 1);
  ck_assert_double_eq_tol(degrees(head.nearest_speed(radians(51))), 50, 1e-9);
  ck_assert_double_eq_tol(degrees(head.nearest_speed(radians(-51))), -50, 1e-9);
  ck_assert_double_eq_tol(degrees(head.true_speed(radians(51))), 30, 1e-9);
  ck_assert_double_eq_tol(degrees(head.true_speed(radians(-51))), -30, 1e-9);
  ck_assert_double_eq_tol(degrees(head.true_speed(radians(2))), 0, 1e-9);  // under half of the slowest
  head.command(at(51), Time{});
  head.elapse(2s);
  ck_assert_double_eq_tol(degrees(head.speed()), 30, 1e-6);
}
END_TEST

// Half a degree of play to both sides: to the right by 10 leaves the camera at 9.5, and back to 9.4 does not move it.
START_TEST(play_is_taken_up_before_the_camera_turns) {
  HeadTraits traits;
  traits.play = radians(1);
  PanHead head(traits, 1);
  head.command(to(10), Time{});
  head.elapse(2s);
  ck_assert_double_eq_tol(degrees(head.camera()), 9.5, .05);
  head.command(to(9.4), 2s);
  head.elapse(4s);
  ck_assert_double_eq_tol(degrees(head.camera()), 9.5, .05);
  head.command(to(8), 4s);
  head.elapse(6s);
  ck_assert_double_eq_tol(degrees(head.camera()), 8.5, .05);
}
END_TEST

START_TEST(a_camera_in_steps_rests_at_multiples_of_the_step) {
  HeadTraits traits;
  traits.step = radians(.44);
  PanHead head(traits, 1);
  head.command(to(10), Time{});
  for (Time now{}; now < 2s; now += 10ms) {
    head.elapse(now);
    const double steps = degrees(head.camera()) / .44;
    ck_assert_double_eq_tol(steps, std::round(steps), 1e-9);
  }
  ck_assert_double_eq_tol(degrees(head.camera()), 23 * .44, 1e-9);  // of 10: 22.7 steps
}
END_TEST

START_TEST(a_head_that_only_turns_takes_no_position) {
  HeadTraits traits;
  traits.turns_only = true;
  PanHead head(traits, 1);
  head.command(at(20), Time{});
  head.elapse(1s);
  ck_assert(head.busy());
  head.command(to(90), 1s);
  head.elapse(2s);
  ck_assert_double_eq(head.speed(), 0);
  ck_assert(!head.busy());
}
END_TEST

START_TEST(one_seed_gives_one_way) {
  HeadTraits traits;
  traits.jitter = .02;
  ck_assert(way(traits, 7) == way(traits, 7));
  ck_assert(way(traits, 7) != way(traits, 8));
}
END_TEST

START_TEST(heads_of_a_kind_differ_in_what_is_unknown_of_them) {
  double least = 1, most = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    const HeadKind b = head_kind('B', seed), k = head_kind('K', seed);
    least = std::min(least, b.traits.dead_time);
    most = std::max(most, b.traits.dead_time);
    ck_assert_double_eq(b.told_dead_time, .15);
    ck_assert_double_eq(b.traits.table_scale, k.traits.table_scale);
    ck_assert(k.calibrated && !b.calibrated);
    ck_assert_double_eq(head_kind('A', seed).traits.dead_time, .06);
  }
  ck_assert(least >= .08 && least < .1 && most <= .25 && most > .23);
  ck_assert(head_kind('F', 1).reports);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "sim_head", {a_command_takes_effect_after_the_dead_time,
                   a_dead_time_varies_within_its_jitter_and_keeps_the_order_of_commands,
                   speed_and_acceleration_keep_their_limits, it_brakes_in_time_and_rests_where_it_was_sent,
                   a_table_of_speeds_is_neither_even_nor_fine, play_is_taken_up_before_the_camera_turns,
                   a_camera_in_steps_rests_at_multiples_of_the_step, a_head_that_only_turns_takes_no_position,
                   one_seed_gives_one_way, heads_of_a_kind_differ_in_what_is_unknown_of_them});
}
