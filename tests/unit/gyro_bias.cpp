// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/gyro/gyro_bias.h"

#include <cmath>
#include <functional>

#include "support/suite.h"

namespace {

using namespace cerberus::control;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using Time = GyroBias::Time;

// A gyro at 50 samples a second and a camera at 25 frames a second, whose frames arrive 100 ms late.
struct Robot {
  GyroBias bias;
  Time now{};
  double true_bias = 5;  // degrees a second, as all that follow
  double turn_rate = 0;
  bool head_rests = true, sees = true,
       looks = true;              // sees: what moves; looks: frames have a measured motion
  std::optional<double> reports;  // the robot, ten times a second
  std::optional<double> rate;     // as add() returned it

  void run(Time duration) {
    for (const Time end = now + duration; now < end; now += 20ms) {
      const auto found = bias.add(now, radians(turn_rate + true_bias));
      rate = found ? std::optional(degrees(*found)) : std::nullopt;
      if (reports && now % 100ms == 0ms) bias.robot(now, radians(*reports));
      if (now % 40ms != 0ms || now < 100ms) continue;
      const Turn turn{sees ? radians(turn_rate * .04) : 0, 0};
      bias.frame(now - 100ms, looks ? std::optional(turn) : std::nullopt, head_rests);
    }
  }
};

START_TEST(until_the_base_has_stood_for_a_second_there_is_no_rate) {
  Robot robot;
  robot.run(1s);
  ck_assert(!robot.rate);
  robot.run(300ms);
  ck_assert(robot.rate);
  ck_assert_double_eq_tol(*robot.rate, 0, 1e-9);
}
END_TEST

START_TEST(a_turn_is_measured_without_the_bias) {
  Robot robot;
  robot.run(3s);
  robot.turn_rate = 30;
  robot.run(5s);
  ck_assert_double_eq_tol(*robot.rate, 30, 1e-9);
  robot.turn_rate = -12.5;
  robot.run(5s);
  ck_assert_double_eq_tol(*robot.rate, -12.5, 1e-9);
}
END_TEST

START_TEST(a_bias_that_drifts_is_followed_while_the_base_stands) {
  Robot robot;
  robot.run(3s);
  robot.true_bias = 5.4;
  robot.run(40ms);
  ck_assert_double_eq_tol(*robot.rate, .4, 1e-9);
  robot.run(30s);  // .4 x .8^29 < .001
  ck_assert_double_eq_tol(*robot.rate, 0, .001);
}
END_TEST

START_TEST(a_slow_turn_is_no_bias_although_no_frame_shows_it) {
  Robot robot;
  robot.turn_rate = 1;  // .04 degrees a frame, below the noise; one degree a span
  robot.run(10s);
  ck_assert(!robot.rate);
}
END_TEST

START_TEST(a_turn_that_the_picture_hides_is_no_bias_where_the_gyro_shows_it) {
  Robot robot;
  robot.sees = false;
  robot.run(500ms);
  robot.turn_rate = 10;  // the span has both
  robot.run(600ms);
  ck_assert(!robot.rate);
}
END_TEST

START_TEST(no_gyro_has_a_bias_of_forty_degrees_a_second) {
  Robot robot;
  robot.sees = false;  // a lens cap that shows a motion of nothing
  robot.turn_rate = 40;
  robot.run(10s);
  ck_assert(!robot.rate);
}
END_TEST

START_TEST(a_head_that_moves_or_a_picture_without_measure_tells_nothing) {
  for (bool Robot::* what : {&Robot::head_rests, &Robot::looks}) {
    Robot robot;
    robot.*what = false;
    robot.run(10s);
    ck_assert(!robot.rate);
    robot.*what = true;
    robot.run(2s);
    ck_assert(robot.rate);
  }
}
END_TEST

START_TEST(the_word_of_a_robot_that_stands_teaches_the_bias_without_a_camera) {
  Robot robot;
  robot.looks = false;
  robot.reports = 0;
  robot.run(3s);
  ck_assert(!robot.rate);  // its word holds
  ck_assert(robot.bias.bias());
  robot.reports.reset();
  robot.run(1100ms);
  ck_assert_double_eq_tol(*robot.rate, 0, 1e-9);
}
END_TEST

START_TEST(the_word_of_a_robot_that_turns_goes_before_gyro_and_picture) {
  Robot robot;
  robot.sees = false;
  robot.reports = 3;
  robot.turn_rate = 3;
  robot.run(10s);
  ck_assert(!robot.bias.bias());
}
END_TEST

START_TEST(time_that_begins_anew_mixes_no_spans) {
  Robot robot;
  robot.run(900ms);
  robot.now = 0s;  // a flush
  robot.true_bias = 9;
  robot.run(900ms);
  ck_assert(!robot.rate);
  robot.run(1s);
  ck_assert(robot.rate);
  ck_assert_double_eq_tol(*robot.rate, 0, 1e-9);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "gyro_bias",
      {until_the_base_has_stood_for_a_second_there_is_no_rate, a_turn_is_measured_without_the_bias,
       a_bias_that_drifts_is_followed_while_the_base_stands,
       a_slow_turn_is_no_bias_although_no_frame_shows_it,
       a_turn_that_the_picture_hides_is_no_bias_where_the_gyro_shows_it,
       no_gyro_has_a_bias_of_forty_degrees_a_second,
       a_head_that_moves_or_a_picture_without_measure_tells_nothing,
       the_word_of_a_robot_that_stands_teaches_the_bias_without_a_camera,
       the_word_of_a_robot_that_turns_goes_before_gyro_and_picture, time_that_begins_anew_mixes_no_spans});
}
