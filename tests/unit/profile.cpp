// SPDX-License-Identifier: LGPL-2.1-or-later
// The way of an axis against times and places worked out by hand, with limits that give round numbers: 2 a second and 4
// a second squared, so 0.5 s and 0.5 of way to full speed.
#include "motion/profile.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "../support/suite.h"

using namespace cerberus::motion;
using namespace std::chrono_literals;
using Kind = AxisCommand::Kind;

namespace {

constexpr AxisLimits kLimits{-10, 10, 2, 4};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void assert_at(const Plan& plan, Time time, double position, double speed) {
  const AxisState state = plan.at(time);
  ck_assert_double_eq_tol(state.position, position, 1e-7);
  ck_assert_double_eq_tol(state.speed, speed, 1e-7);
}

}  // namespace

// 0 to 4: 0.5 s up, 3 of way at 2 a second, 0.5 s down: 2.5 s.
START_TEST(a_long_way_is_a_trapezoid) {
  const Plan plan = Plan::make(1s, {}, {Kind::position, 4, 2}, kLimits);
  assert_at(plan, 0s, 0, 0);
  assert_at(plan, 1250ms, 0.125, 1);
  assert_at(plan, 1500ms, 0.5, 2);
  assert_at(plan, 2s, 1.5, 2);
  assert_at(plan, 3s, 3.5, 2);
  assert_at(plan, 3250ms, 3.875, 1);
  assert_at(plan, 3500ms, 4, 0);
  assert_at(plan, 99s, 4, 0);
  ck_assert_int_eq(plan.end().count(), Time(3500ms).count());
  ck_assert_double_eq(plan.at(1100ms).acceleration, 4);
  ck_assert_double_eq(plan.at(2s).acceleration, 0);
  ck_assert_double_eq(plan.at(3300ms).acceleration, -4);
}
END_TEST

// 0 to -0.25: a triangle of 0.25 s up (to 1 a second) and 0.25 s down.
START_TEST(a_short_way_is_a_triangle) {
  const Plan plan = Plan::make(0s, {}, {Kind::position, -0.25, 2}, kLimits);
  assert_at(plan, 250ms, -0.125, -1);
  assert_at(plan, 500ms, -0.25, 0);
  ck_assert_int_eq(plan.end().count(), Time(500ms).count());
}
END_TEST

START_TEST(the_speed_of_the_command_counts_below_the_limit) {
  const Plan plan = Plan::make(0s, {}, {Kind::position, 4, 1}, kLimits);
  assert_at(plan, 2s, 0.125 + 1.75, 1);
  const Plan fast = Plan::make(0s, {}, {Kind::position, 4, 50}, kLimits);
  assert_at(fast, 1s, 1.5, 2);
}
END_TEST

// At 2 a second, commanded back to where it is: brakes in 0.5 s and 0.5 of way, then returns by a triangle of
// 2 sqrt(0.5 / 4) s.
START_TEST(an_axis_that_goes_the_wrong_way_brakes_first) {
  const Plan plan = Plan::make(0s, {0, 2, 0}, {Kind::position, 0, 2}, kLimits);
  assert_at(plan, 500ms, 0.5, 0);
  const double half = std::sqrt(0.5 / 4);
  ck_assert_double_eq_tol(seconds(plan.end()), 0.5 + 2 * half, 1e-8);
  assert_at(plan, Time(static_cast<Time::rep>((0.5 + half) * 1e9)), 0.25, -4 * half);
  assert_at(plan, 3s, 0, 0);
}
END_TEST

// At 2 a second with a limit of 1 from now on: 0.25 s and 0.375 of way down to 1, later 0.125 of way to rest.
START_TEST(an_axis_that_is_too_fast_slows_down) {
  const Plan plan = Plan::make(0s, {0, 2, 0}, {Kind::position, 4, 1}, kLimits);
  assert_at(plan, 250ms, 0.375, 1);
  assert_at(plan, 1250ms, 1.375, 1);
  ck_assert_double_eq_tol(seconds(plan.end()), 0.25 + (4 - 0.375 - 0.125) + 0.25, 1e-8);
}
END_TEST

START_TEST(a_velocity_ends_at_the_stop) {
  const Plan plan = Plan::make(0s, {8, 0, 0}, {Kind::velocity, 1, 0}, kLimits);
  assert_at(plan, 1s, 8 + 0.125 + 0.75, 1);
  assert_at(plan, 60s, 10, 0);
  ck_assert_double_eq(Plan::make(0s, {}, {Kind::velocity, -1, 0}, kLimits).target(), -10);
}
END_TEST

START_TEST(hold_brakes_as_hard_as_permitted_and_stays) {
  const Plan plan = Plan::make(0s, {1, -2, 0}, {}, kLimits);
  assert_at(plan, 500ms, 0.5, 0);
  assert_at(plan, 60s, 0.5, 0);
  assert_at(Plan::make(0s, {1, 0, 0}, {}, kLimits), 60s, 1, 0);
}
END_TEST

START_TEST(targets_beyond_a_stop_end_at_it) {
  assert_at(Plan::make(0s, {}, {Kind::position, 500, 2}, kLimits), 60s, 10, 0);
  assert_at(Plan::make(0s, {}, {Kind::position, -500, 2}, kLimits), 60s, -10, 0);
}
END_TEST

// 1 before the stop at 4 a second, the permitted acceleration would need 2 of way: 16 / 2 = 8 a second squared.
START_TEST(what_cannot_be_stopped_gently_is_stopped_at_the_stop) {
  const Plan plan = Plan::make(0s, {9, 4, 0}, {}, kLimits);
  ck_assert_double_eq_tol(plan.at(0s).acceleration, -8, 1e-9);
  assert_at(plan, 500ms, 10, 0);
  assert_at(Plan::make(0s, {10, 4, 0}, {}, kLimits), 1ns, 10, 0);
}
END_TEST

START_TEST(rest_is_on_the_grid_of_steps) {
  ck_assert_double_eq_tol(Plan::make(0s, {}, {Kind::position, 0.74, 2}, kLimits, 0.5).target(), 0.5, 1e-12);
  ck_assert_double_eq_tol(Plan::make(0s, {}, {Kind::position, 0.76, 2}, kLimits, 0.5).target(), 1, 1e-12);
  // Braking from 2 ends at 0.5 + 0.1: the next step in its direction is 1, not back at 0.5.
  ck_assert_double_eq_tol(Plan::make(0s, {0.1, 2, 0}, {}, kLimits, 0.5).target(), 1, 1e-12);
  // No step lies beyond a stop.
  ck_assert_double_eq_tol(Plan::make(0s, {}, {Kind::position, 10, 2}, kLimits, 3).target(), 9, 1e-12);
}
END_TEST

START_TEST(pieces_end_where_the_acceleration_changes) {
  const Plan plan = Plan::make(1s, {}, {Kind::position, 4, 2}, kLimits);
  ck_assert_int_eq(plan.piece_end(0s).count(), Time(1s).count());
  ck_assert_int_eq(plan.piece_end(1s).count(), Time(1500ms).count());
  ck_assert_int_eq(plan.piece_end(1500ms).count(), Time(3s).count());
  ck_assert_int_eq(plan.piece_end(3s).count(), Time(3500ms).count());
  ck_assert_int_eq(plan.piece_end(3500ms).count(), kNever.count());
}
END_TEST

START_TEST(numbers_that_are_none_brake) {
  for (const AxisCommand& command :
       {AxisCommand{Kind::position, kNan, 2}, AxisCommand{Kind::position, 3, kNan},
        AxisCommand{Kind::position, 3, 0}, AxisCommand{Kind::position, 3, -1},
        AxisCommand{Kind::velocity, kNan, 0}, AxisCommand{Kind::velocity, HUGE_VAL, 0},
        AxisCommand{Kind::position, HUGE_VAL, 1}})
    assert_at(Plan::make(0s, {0, 2, 0}, command, kLimits), 60s, 0.5, 0);
  assert_at(Plan::make(0s, {kNan, kNan, kNan}, {}, kLimits), 1s, 0, 0);
}
END_TEST

// Whatever is commanded whenever: never beyond a stop, never faster than permitted (but for what it began with),
// position and speed without a jump, rest at the end.
START_TEST(no_commands_make_an_axis_jump_or_pass_its_stops) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-15, 15), speed(-3, 3), wait(0, 1.5);
  AxisState state;
  Time now{};
  for (int k = 0; k < 3000; ++k) {
    const AxisCommand command{static_cast<Kind>(k % 3), k % 3 == 1 ? place(random) : speed(random),
                              speed(random)};
    const Plan plan = Plan::make(now, state, command, kLimits, k % 2 ? 0.05 : 0);
    ck_assert_double_eq_tol(plan.at(now).position, state.position, 1e-6);
    const Time until = now + Time(static_cast<Time::rep>(wait(random) * 1e9));
    AxisState last = plan.at(now);
    // The worst of 5 ms steps: an assertion for each of them costs more than the plan.
    double fastest = 0, change = 0, step = 0;
    bool sound = true;
    for (Time t = now; t <= until; t += 5ms) {
      const AxisState s = plan.at(t);
      sound = sound && kLimits.holds(s.position) && std::isfinite(s.speed);
      fastest = std::max(fastest, std::abs(s.speed));
      change = std::max(change, std::abs(s.speed - last.speed));
      step = std::max(step, std::abs(s.position - last.position));
      last = s;
    }
    ck_assert(sound);
    ck_assert_double_le(fastest, 2 + 1e-6);
    ck_assert_double_le(change, 4 * 0.005 + 1e-6);
    ck_assert_double_le(step, 2 * 0.005 + 1e-6);
    ck_assert(!plan.at(plan.end()).moving());
    state = plan.at(until);
    now = until;
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "profile",
      {a_long_way_is_a_trapezoid, a_short_way_is_a_triangle, the_speed_of_the_command_counts_below_the_limit,
       an_axis_that_goes_the_wrong_way_brakes_first, an_axis_that_is_too_fast_slows_down,
       a_velocity_ends_at_the_stop, hold_brakes_as_hard_as_permitted_and_stays,
       targets_beyond_a_stop_end_at_it, what_cannot_be_stopped_gently_is_stopped_at_the_stop,
       rest_is_on_the_grid_of_steps, pieces_end_where_the_acceleration_changes, numbers_that_are_none_brake,
       no_commands_make_an_axis_jump_or_pass_its_stops});
}
