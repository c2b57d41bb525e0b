// SPDX-License-Identifier: LGPL-2.1-or-later
// Expected values by hand from the formulas in the header.
#include "control/pose_estimate.h"

#include <chrono>
#include <cmath>
#include <limits>

#include "control/pose_correction.h"
#include "motion/stop_margin.h"
#include "support/suite.h"

using namespace cerberus::control;
using namespace std::chrono_literals;
using cerberus::motion::Limits;
using cerberus::motion::Pose;
using cerberus::motion::stop_margin;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

// Deviations of .01 for a reckoned turn of .1, and of .01 for every turn of the picture.
constexpr PoseEstimate::Parameters kEqual{
    .reckoning_scale = 0.1, .picture_scale = 0, .picture_noise = 0.01, .gate = 3, .slack = 0, .lost = 0.05};

Pose at(std::chrono::nanoseconds time, double pan, double speed = 0, bool measured = false) {
  Pose pose;
  pose.from = time;
  pose.pan = {pan, speed, 0};
  pose.measured = measured;
  return pose;
}

Limits one_radian() {
  Limits limits;
  limits.pan.from = limits.tilt.from = -1;
  limits.pan.to = limits.tilt.to = 1;
  return limits;
}

}  // namespace

START_TEST(a_turn_that_both_know_is_their_mean_by_variance) {
  PoseEstimate estimate(kEqual);
  estimate.add({0.1, 0}, Turn{0.12, 0});
  ck_assert_double_eq_tol(estimate.position().pan, 0.11, 1e-12);
  ck_assert_double_eq_tol(estimate.uncertainty(), std::sqrt(0.5) * 0.01, 1e-12);  // weight .5 x .01^2
  estimate.add({-0.1, 0}, Turn{-0.12, 0});
  ck_assert_double_eq_tol(estimate.position().pan, 0, 1e-12);
  ck_assert_double_eq_tol(estimate.uncertainty(), 0.01, 1e-12);  // two of them
}
END_TEST

START_TEST(without_the_picture_the_head_is_where_its_speeds_led_and_less_sure) {
  PoseEstimate estimate(kEqual);
  estimate.reset({0.5, -0.25});
  estimate.add({0.2, 0.1}, std::nullopt);
  estimate.add({-0.2, 0}, Turn{std::numeric_limits<double>::quiet_NaN(), 0});
  ck_assert_double_eq_tol(estimate.position().pan, 0.5, 1e-12);
  ck_assert_double_eq_tol(estimate.position().tilt, -0.15, 1e-12);
  ck_assert_double_eq_tol(estimate.uncertainty(), 0.04, 1e-12);  // .02 there and .02 back
}
END_TEST

START_TEST(where_the_picture_contradicts_it_is_believed) {
  PoseEstimate estimate(kEqual);
  estimate.add({0.1, 0}, Turn{0.04, 0});  // .06 = 3 x (.01 + .01): just no contradiction
  ck_assert_double_eq_tol(estimate.position().pan, 0.07, 1e-12);
  estimate.add({0.1, 0}, Turn{0, 0});  // the head does not turn
  ck_assert_double_eq_tol(estimate.position().pan, 0.07, 1e-12);
}
END_TEST

START_TEST(noise_of_the_picture_does_not_move_a_head_at_rest) {
  PoseEstimate estimate;
  for (int i = 0; i < 100000; ++i) estimate.add({}, Turn{radians(0.2), radians(-0.2)});
  ck_assert_double_eq(estimate.position().pan, 0);
  ck_assert_double_eq(estimate.uncertainty(), 0);
}
END_TEST

// A field of view that is 2 % wrong is wrong by 2 % of the way to the reference, and right again there.
START_TEST(the_error_of_the_lens_returns_to_zero_with_the_head) {
  PoseEstimate::Parameters parameters;
  parameters.picture_noise = 0;
  PoseEstimate estimate(parameters);
  estimate.add({1, 0}, Turn{1, 0});
  ck_assert_double_eq_tol(estimate.uncertainty(), 0.02, 1e-12);
  estimate.add({-1, 0}, Turn{-1, 0});
  ck_assert_double_eq_tol(estimate.uncertainty(), 0, 1e-12);
}
END_TEST

// .15 and .02 of the way: 8 degrees after 47.06 degrees of turning unseen.
START_TEST(a_head_that_turned_far_unseen_has_lost_its_reference_until_it_is_found) {
  PoseEstimate estimate;
  estimate.add({radians(47), 0}, std::nullopt);
  ck_assert(!estimate.lost());
  estimate.add({radians(0.1), 0}, std::nullopt);
  ck_assert(estimate.lost());
  estimate.reset({});
  ck_assert(!estimate.lost());
  ck_assert_double_eq(estimate.uncertainty(), 0);
}
END_TEST

START_TEST(the_stop_margin_is_the_way_until_the_stop_and_the_uncertainty) {
  ck_assert_double_eq_tol(stop_margin(0.5, 0.2, 0.05, 2), 0.15, 1e-12);
  ck_assert_double_eq_tol(stop_margin(-0.5, 0.2, 0.05, 2), 0.05, 1e-12);  // away from the limit
  ck_assert_double_eq_tol(stop_margin(9, 9, 9, 2), 0.5, 1e-12);           // a quarter of the range
}
END_TEST

// The driver reckons .1 and .2; the picture shows .09 and .18, which is believed (with the usual noise to a thousandth).
START_TEST(poses_commands_and_limits_are_shifted_by_what_the_picture_shows) {
  PoseCorrection correction;
  correction.reset(at(0s, 0), 100ms);
  Pose first = at(1s, 0), second = at(2s, 0.1), third = at(3s, 0.2);
  correction.add(first);
  ck_assert(!correction.on_frame(1s, first, std::nullopt, one_radian()));
  correction.add(second);
  correction.on_frame(2s, second, Turn{0.09, 0}, one_radian());
  const double shift = correction.position()->pan - 0.1;
  ck_assert_double_lt(shift, -0.009);
  ck_assert_double_gt(shift, -0.010001);
  correction.add(third);
  ck_assert_double_eq_tol(third.pan.position, 0.2 + shift, 1e-12);
  ck_assert_double_eq_tol(correction.driver_pose(3s).pan.position, 0.2, 1e-12);
  cerberus::drivers::HeadCommand command{3s, {Kind::position, 0.5, 1}, {Kind::velocity, 0.5, 0}};
  correction.to_driver(command);
  ck_assert_double_eq_tol(command.pan.value, 0.5 - shift, 1e-12);
  ck_assert_double_eq_tol(command.tilt.value, 0.5, 1e-12);
  // The margin: .02 x .09 for the lens and less than a tenth of a degree of noise.
  const Limits driver = correction.limits(one_radian());
  ck_assert_double_eq_tol(driver.pan.to, 1 - shift - 0.0018, 0.001);
  ck_assert_double_eq_tol(driver.pan.from, -1 - shift + 0.0018, 0.001);
}
END_TEST

START_TEST(a_head_that_turns_is_stopped_earlier_on_the_side_that_it_turns_to) {
  PoseCorrection correction;
  correction.reset(at(0s, 0), 100ms);
  ck_assert(correction.on_frame(0s, at(0s, 0, 2), std::nullopt, one_radian()));  // 2 rad/s x .1 s
  const Limits limits = correction.narrowed(one_radian());
  ck_assert_double_eq_tol(limits.pan.to, 0.8, 1e-12);
  ck_assert_double_eq_tol(limits.pan.from, -1, 1e-12);
}
END_TEST

START_TEST(a_head_that_measures_its_position_is_left_alone) {
  PoseCorrection correction;
  correction.reset(at(0s, 0), 0ms);
  for (int i = 1; i < 5; ++i) {
    Pose pose = at(i * 1s, 0.1 * i, 0, true);
    correction.add(pose);
    ck_assert_double_eq(pose.pan.position, 0.1 * i);
    ck_assert(!correction.on_frame(i * 1s, pose, Turn{0, 0}, one_radian()));
    ck_assert(!correction.position());
  }
  ck_assert(correction.limits(one_radian()) == one_radian());
}
END_TEST

START_TEST(a_reference_ends_the_loss) {
  PoseCorrection correction;
  correction.reset(at(0s, 0), 0ms);
  correction.on_frame(0s, at(0s, 0), std::nullopt, one_radian());
  Pose far = at(1s, 0.9);
  correction.add(far);
  correction.on_frame(1s, far, std::nullopt, one_radian());
  ck_assert(correction.lost());
  Pose home = at(2s, 0, 0, true);
  correction.add(home);
  ck_assert(correction.on_frame(2s, home, std::nullopt, one_radian()));  // the limits are wide again
  ck_assert(!correction.lost());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "pose_estimate",
      {a_turn_that_both_know_is_their_mean_by_variance,
       without_the_picture_the_head_is_where_its_speeds_led_and_less_sure,
       where_the_picture_contradicts_it_is_believed, noise_of_the_picture_does_not_move_a_head_at_rest,
       the_error_of_the_lens_returns_to_zero_with_the_head,
       a_head_that_turned_far_unseen_has_lost_its_reference_until_it_is_found,
       the_stop_margin_is_the_way_until_the_stop_and_the_uncertainty,
       poses_commands_and_limits_are_shifted_by_what_the_picture_shows,
       a_head_that_turns_is_stopped_earlier_on_the_side_that_it_turns_to,
       a_head_that_measures_its_position_is_left_alone, a_reference_ends_the_loss});
}
