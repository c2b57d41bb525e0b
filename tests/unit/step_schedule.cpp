// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/stepper/step_schedule.h"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "support/suite.h"

using namespace cerberus::motion;
using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::radians;
using Kind = AxisCommand::Kind;

namespace {

constexpr double kStep = radians(0.1);
const StepGeometry kGeometry{kStep, 0, 1ms};
const AxisLimits kLimits{radians(-170), radians(170), radians(50), radians(500)};

struct Step {
  Time time;
  int direction;
};

// Executes all steps at their deadlines, until `end`.
std::vector<Step> run(StepSchedule& schedule, Time end = kNever) {
  std::vector<Step> steps;
  while (schedule.next() < end) {
    const Time now = schedule.next();
    steps.push_back({now, schedule.direction()});
    schedule.advance(now);
    ck_assert(steps.size() < 1000000);
  }
  return steps;
}

double deg(const AxisLimits& l) {
  return l.speed;
}

}  // namespace

START_TEST(a_move_of_90_degrees_takes_900_steps_of_a_tenth_of_a_degree) {
  StepSchedule schedule(kGeometry);
  schedule.command(0s, {Kind::position, radians(90), 10}, kLimits);
  const auto steps = run(schedule);
  ck_assert_uint_eq(steps.size(), 900);
  for (const Step& step : steps) ck_assert_int_eq(step.direction, 1);
  ck_assert_double_eq_tol(schedule.load(), radians(90), 1e-9);
  ck_assert(!schedule.moving());
  // Trapezoid: 90 / 50 s + 50 / 500 s = 1.9 s. The first step is due at sqrt(2 x .05 / 500) s, the last as long before
  // the end.
  const double half = std::sqrt(2 * 0.05 / 500);
  ck_assert_double_eq_tol(seconds(steps.front().time), half, 1e-8);
  ck_assert_double_eq_tol(seconds(steps.back().time), 1.9 - half, 1e-6);
  // At full speed 500 steps a second; while it speeds up step n is due at sqrt(2 (n + .5) .1 / 500).
  ck_assert_double_eq_tol(seconds(steps[450].time - steps[449].time), 0.002, 1e-8);
  for (unsigned n = 0; n < 24; ++n)
    ck_assert_double_eq_tol(seconds(steps[n].time), std::sqrt(2 * (n + 0.5) * 0.1 / 500), 1e-8);
}
END_TEST

START_TEST(a_28byj48_goes_90_degrees_in_1019_half_steps) {
  // 4075.7728 / 4 = 1018.94: the nearest whole number, and off by less than half a step of 0.0883 degrees.
  StepSchedule schedule({2 * std::numbers::pi / 4075.7728395, 0, 1ms});
  schedule.command(0s, {Kind::position, radians(90), 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 1019);
  ck_assert_double_eq_tol(schedule.load(), radians(90), 2 * std::numbers::pi / 4075.77 / 2);
  schedule.command(10s, {Kind::position, 0, 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 1019);
  ck_assert_int_eq(schedule.count(), 0);
}
END_TEST

START_TEST(random_commands_in_motion_lose_no_step_and_break_no_limit) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-200, 200), speed(1, 80);
  StepSchedule schedule({radians(0.0879), radians(0.6), 1ms});
  Time now = 0s, last = -1s;
  for (int k = 0; k < 300; ++k) {
    const bool at = k % 3 == 0;
    schedule.command(now,
                     {at ? Kind::velocity : Kind::position, radians(at ? angle(random) / 4 : angle(random)),
                      radians(speed(random))},
                     kLimits);
    now += Time(37ms * (k % 7 + 1));
    for (const Step& step : run(schedule, now)) {
      ck_assert(step.time - last >= 1ms);
      last = step.time;
      ck_assert(kLimits.holds(schedule.load()));
    }
    // Less than a step from the plan's speed: never two directions within a step's time at full speed.
    ck_assert(std::abs(schedule.speed(now)) <= deg(kLimits) + 1e-9);
  }
  schedule.command(now, {Kind::position, radians(12.3), 10}, kLimits);
  run(schedule);
  ck_assert_double_eq_tol(schedule.load(), radians(12.3), radians(0.0879) / 2 + 1e-9);
}
END_TEST

START_TEST(backlash_is_taken_up_at_each_change_of_direction) {
  StepSchedule schedule({kStep, radians(1), 1ms});  // ten steps of play
  schedule.command(0s, {Kind::position, radians(10), 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 100);  // pushed to the right from the start
  schedule.command(10s, {Kind::position, radians(5), 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 60);  // 50, and the play
  ck_assert_double_eq_tol(schedule.load(), radians(5), 1e-9);
  schedule.command(20s, {Kind::position, radians(2), 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 30);  // on, in the same direction
  schedule.command(30s, {Kind::position, radians(10), 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 90);
  ck_assert_double_eq_tol(schedule.load(), radians(10), 1e-9);
  ck_assert_int_eq(schedule.count(), 100);
}
END_TEST

START_TEST(a_motor_is_not_asked_for_more_than_it_follows) {
  StepSchedule schedule({kStep, 0, 4ms});  // 25 degrees a second
  schedule.command(0s, {Kind::position, radians(50), 10}, kLimits);
  Time last = -1s;
  for (const Step& step : run(schedule)) {
    ck_assert(step.time - last >= 4ms - 2ns);
    last = step.time;
  }
  // 50 / 25 + 25 / 500 s
  ck_assert_double_eq_tol(seconds(last), 2.05, 0.02);
}
END_TEST

START_TEST(a_late_step_delays_the_next_ones_and_the_plan_is_reached_again) {
  StepSchedule schedule({kStep, 0, 1ms});
  schedule.command(0s, {Kind::position, radians(90), 10}, kLimits);
  run(schedule, 1s);
  const Time planned = schedule.planned();
  schedule.advance(planned + 6ms);  // 6 ms late: three steps of 2 ms are due by then
  for (int k = 1; k <= 3; ++k) {
    ck_assert_int_eq(schedule.next().count(), (planned + 6ms + k * 1ms).count());
    schedule.advance(schedule.next());
  }
  run(schedule, planned + 20ms);
  ck_assert_int_eq(schedule.next().count(), schedule.planned().count());
  run(schedule);
  ck_assert_double_eq_tol(schedule.load(), radians(90), 1e-9);
}
END_TEST

START_TEST(a_cut_schedule_rests_where_it_is) {
  StepSchedule schedule(kGeometry);
  schedule.command(0s, {Kind::velocity, 1, 0}, kLimits);
  run(schedule, 500ms);
  const auto count = schedule.count();
  ck_assert(count > 0);
  schedule.cut();
  ck_assert(schedule.next() == kNever);
  ck_assert(!schedule.moving());
  ck_assert_double_eq_tol(schedule.load(), static_cast<double>(count) * kStep, 1e-9);
  ck_assert_double_eq(schedule.speed(600ms), 0);
}
END_TEST

START_TEST(hold_brakes_and_a_load_beyond_its_limits_returns) {
  StepSchedule schedule(kGeometry);
  schedule.command(0s, {Kind::velocity, 10, 0}, kLimits);
  run(schedule, 1s);
  schedule.command(1s, {}, kLimits);
  const auto steps = run(schedule);
  ck_assert_double_eq_tol(static_cast<double>(steps.size()), 25, 1.5);  // 50^2 / (2 x 500) = 2.5 degrees
  const AxisLimits narrow{radians(-10), radians(10.04), radians(50), radians(500)};
  schedule.command(5s, {}, narrow);
  run(schedule);
  ck_assert_double_eq_tol(schedule.load(), radians(10), 1e-9);  // the last whole step within
}
END_TEST

START_TEST(numbers_that_are_none_and_an_axis_without_range_move_nothing) {
  StepSchedule schedule(kGeometry);
  schedule.place(0.2);
  for (const double none : {std::nan(""), HUGE_VAL, -HUGE_VAL})
    for (const Kind kind : {Kind::position, Kind::velocity}) {
      schedule.command(0s, {kind, none, 1}, kLimits);
      ck_assert(schedule.next() == kNever);
    }
  schedule.place(0);
  schedule.command(0s, {Kind::position, 1, 1}, {0, 0, 1, 1});
  ck_assert(schedule.next() == kNever);
  ck_assert_double_eq(schedule.load(), 0);
}
END_TEST

START_TEST(placing_the_load_moves_no_motor) {
  StepSchedule schedule(kGeometry);
  schedule.command(0s, {Kind::position, radians(3), 10}, kLimits);
  run(schedule);
  schedule.place(radians(-100));
  ck_assert_int_eq(schedule.count(), 30);  // the coils stay in their phase
  schedule.command(5s, {Kind::position, radians(-99), 10}, kLimits);
  ck_assert_uint_eq(run(schedule).size(), 10);
  ck_assert_double_eq_tol(schedule.load(), radians(-99), 1e-9);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "step_schedule",
      {a_move_of_90_degrees_takes_900_steps_of_a_tenth_of_a_degree,
       a_28byj48_goes_90_degrees_in_1019_half_steps,
       random_commands_in_motion_lose_no_step_and_break_no_limit,
       backlash_is_taken_up_at_each_change_of_direction, a_motor_is_not_asked_for_more_than_it_follows,
       a_late_step_delays_the_next_ones_and_the_plan_is_reached_again, a_cut_schedule_rests_where_it_is,
       hold_brakes_and_a_load_beyond_its_limits_returns,
       numbers_that_are_none_and_an_axis_without_range_move_nothing, placing_the_load_moves_no_motor});
}
