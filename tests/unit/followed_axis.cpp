// SPDX-License-Identifier: LGPL-2.1-or-later
// One axis in a loop of its own: pictures, a delay until the command, a dead time until it takes effect, and an axis
// that obeys exactly. Degrees and seconds here, radians in the library.
#include "control/following/followed_axis.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::control;
using cerberus::motion::AxisCommand;
using cerberus::motion::AxisLimits;
using cerberus::motion::AxisState;
using cerberus::motion::Plan;
using cerberus::motion::Time;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

using Angle = std::function<double(double)>;

Angle still(double at) {
  return [=](double) { return at; };
}
Angle moving(double speed) {
  return [=](double t) { return speed * t; };
}
// To and fro at a constant speed.
Angle shuttle(double half, double speed) {
  return [=](double t) {
    const double period = 4 * half / speed, at = std::fmod(t, period) / period;
    return half * (at < .25 ? 4 * at : at < .75 ? 2 - 4 * at : 4 * at - 4);
  };
}

Time time_of(double seconds) {
  return Time(static_cast<Time::rep>(std::llround(seconds * 1e9)));
}

struct Loop {
  Angle target = still(0), base = still(0);
  double base_rate = 0;  // of `base`, where it turns
  double frame = .04, delay = .06, dead_time = .06;
  double noise = 0, wander = 0;  // of the angles, degrees; wander: time constant of the noise, seconds
  FollowedAxis::Parameters parameters;
  AxisLimits limits{radians(-170), radians(170), radians(90), radians(300)};

  FollowedAxis axis;
  std::vector<Plan> plans{Plan()};
  std::vector<double> commanded;  // speeds, with their sign
  std::vector<bool> stands;

  AxisState at(double t) const {
    for (std::size_t k = plans.size(); k-- > 1;)
      if (plans[k].start() <= time_of(t)) return plans[k].at(time_of(t));
    return plans[0].at(time_of(t));
  }
  double position(double t) const { return degrees(at(t).position); }
  double error(double t) const { return target(t) - base(t) - position(t); }

  Loop& run(double length, unsigned seed = 1) {
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss(0, 1);
    const double keep = wander > 0 ? std::exp(-frame / wander) : 0;
    double off = 0;
    axis.begin();
    for (double t = 0; t < length; t += frame) {
      off = keep * off + std::sqrt(1 - keep * keep) * noise * gauss(random);
      const FollowedAxis::Times times{t, t + delay + dead_time};
      const BaseTurn turn{radians(base(t)), radians(base(t) + base_rate * times.horizon()),
                          radians(base_rate)};
      const auto aim = axis.observe(radians(target(t) - base(t) + off), turn, times, parameters);
      const AxisState ahead = at(times.effect);
      const AxisCommand command = axis.command(aim, ahead, limits, times, parameters);
      plans.push_back(Plan::make(time_of(times.effect), ahead, command, limits));
      const double sign = command.value < ahead.position ? -1 : 1;
      commanded.push_back(command.kind == AxisCommand::Kind::hold ? 0 : sign * degrees(command.speed));
      stands.push_back(aim.stands);
    }
    return *this;
  }

  double rms(double from, double to) const {
    double squares = 0;
    int n = 0;
    for (double t = from; t < to; t += .01, ++n) squares += error(t) * error(t);
    return std::sqrt(squares / n);
  }
  // Of the axis, by more than a tenth of a degree.
  int reversals(double from, double to) const {
    int found = 0, direction = 0;
    double extreme = position(from);
    for (double t = from; t < to; t += .01) {
      const double here = position(t);
      if (direction >= 0 ? here < extreme - .1 : here > extreme + .1) {
        found += direction != 0;
        direction = here < extreme ? -1 : 1;
        extreme = here;
      }
      extreme = direction < 0 ? std::min(extreme, here) : std::max(extreme, here);
    }
    return found;
  }
};

}  // namespace

// A proportional law of the same bandwidth would trail by 20 / 6.5 = 3 degrees.
START_TEST(it_goes_with_a_target_and_does_not_run_after_it) {
  for (const double speed : {5., 20., -40.}) {
    Loop loop;
    loop.target = moving(speed);
    loop.run(4);
    ck_assert_msg(loop.rms(1.5, 3.5) < .2, "%g degrees a second: off by %g", speed, loop.rms(1.5, 3.5));
  }
}
END_TEST

START_TEST(where_the_target_is_when_the_command_takes_effect_counts) {
  Loop loop;
  loop.target = moving(20);
  loop.delay = .2;
  loop.dead_time = .2;
  loop.run(5);
  ck_assert_double_lt(loop.rms(2, 4.5), .3);
}
END_TEST

START_TEST(a_base_that_turns_is_no_motion_of_the_target) {
  Loop loop;
  loop.base = moving(45);
  loop.base_rate = 45;
  loop.run(3);
  ck_assert_double_lt(loop.rms(1, 2.9), .2);
  // The slow filter is one of the world: the target stands all the time.
  ck_assert(!loop.stands.back());  // but the axis has to turn
  Loop rests;
  rests.run(3);
  ck_assert(rests.stands.back());
}
END_TEST

// 100 pictures a second. 300 degrees a second squared: 3 degrees a second from one command to the next.
START_TEST(speed_acceleration_and_jerk_are_limited) {
  for (const double far : {4., 40., 160.}) {
    Loop loop;
    loop.target = still(far);
    loop.frame = .01;
    loop.limits.speed = radians(60);
    loop.run(5);
    double before = 0, gain = 0;
    int count = 0;
    for (const double speed : loop.commanded) {
      ck_assert_double_le(std::abs(speed), 60 + 1e-6);
      if (speed == 0) break;  // it rests
      // The first command sets out from rest; the axis itself accelerates to it.
      if (count > 0) ck_assert_double_le(std::abs(speed - before), 3 + 1e-6);
      if (count > 1) ck_assert_double_le(std::abs(speed - before - gain), 1 + 1e-6);  // in three commands
      gain = speed - before;
      before = speed;
      ++count;
    }
    ck_assert_int_gt(count, 10);
  }
}
END_TEST

START_TEST(it_brakes_in_time) {
  for (const double far : {5., 30., 120.})
    for (const double frame : {.04, .1})
      for (const double acceleration : {60., 300.}) {
        Loop loop;
        loop.target = still(far);
        loop.frame = frame;
        loop.limits.acceleration = radians(acceleration);
        loop.run(9);
        double most = 0;
        for (double t = 0; t < 9; t += .01) most = std::max(most, loop.position(t));
        ck_assert_msg(most < far + .7, "%g degrees, a picture every %g s: %g", far, frame, most);
        ck_assert_double_eq_tol(loop.position(9), far, .8);
      }
}
END_TEST

// The goal of a command lies beyond a target that goes away: the law brakes, not the axis.
START_TEST(it_does_not_shoot_past_a_target_that_it_catches_up_with) {
  Loop loop;
  loop.target = [](double t) { return 60 + 15 * t; };
  loop.limits.acceleration = radians(60);
  loop.run(5);
  double past = 0;
  for (double t = 0; t < 5; t += .01) past = std::max(past, -loop.error(t));
  ck_assert_msg(past < 1, "%g", past);
}
END_TEST

START_TEST(before_a_target_that_stands_it_rests_though_boxes_wander) {
  for (const double wander : {0., .3}) {
    Loop loop;
    loop.target = still(20);
    loop.noise = 1;
    loop.wander = wander;
    loop.run(63);
    ck_assert_msg(loop.reversals(3, 63) <= (wander > 0 ? 6 : 1), "%d", loop.reversals(3, 63));
    ck_assert_double_lt(loop.rms(3, 63), 3);
  }
}
END_TEST

START_TEST(it_starts_again_when_the_target_goes) {
  Loop loop;
  loop.target = [](double t) { return 10 + 15 * std::max(0., t - 5); };
  loop.noise = 1;
  loop.run(9);
  ck_assert_double_lt(loop.rms(7, 8.5), 1.5);
}
END_TEST

START_TEST(calm_lags_most_and_fast_trembles_most) {
  double lag[3] = {}, trembling[3] = {};
  for (const Response response : {Response::calm, Response::normal, Response::fast}) {
    const auto k = static_cast<std::size_t>(response);
    Loop turns;
    turns.target = shuttle(40, 40);
    turns.parameters.response = response;
    lag[k] = turns.run(23).rms(3, 23);
    Loop noisy;
    noisy.target = moving(15);
    noisy.noise = 1;
    noisy.parameters.response = response;
    noisy.run(9);
    for (std::size_t n = 60; n < noisy.commanded.size(); ++n)
      trembling[k] += std::abs(noisy.commanded[n] - noisy.commanded[n - 1]);
  }
  ck_assert_msg(lag[0] > lag[1] && lag[1] > lag[2], "%g %g %g", lag[0], lag[1], lag[2]);
  ck_assert_msg(trembling[0] < trembling[1] && trembling[1] < trembling[2], "%g %g %g", trembling[0],
                trembling[1], trembling[2]);
}
END_TEST

// A command every 100 ms that takes effect a second later: a loop that does not slow down swings.
START_TEST(a_long_way_from_picture_to_effect_makes_it_slow_and_not_swing) {
  Loop loop;
  loop.target = still(30);
  loop.frame = .1;
  loop.delay = .1;
  loop.dead_time = .9;
  loop.noise = .5;
  loop.run(30);
  ck_assert_int_le(loop.reversals(4, 30), 4);
  ck_assert_double_lt(loop.rms(6, 30), 2);
}
END_TEST

START_TEST(a_new_target_is_centred_and_an_old_one_within_the_band_rests) {
  for (const bool fresh : {false, true}) {
    FollowedAxis axis;
    if (fresh) axis.begin();
    const FollowedAxis::Times times{5, 5.1};
    const auto aim = axis.observe(radians(2), {}, times, {});
    const AxisCommand command = axis.command(aim, {}, AxisLimits{-3, 3}, times, {});
    ck_assert_int_eq(static_cast<int>(command.kind),
                     static_cast<int>(fresh ? AxisCommand::Kind::position : AxisCommand::Kind::hold));
  }
}
END_TEST

// Nothing is known of the distance of pictures at the first one: whatever the time is.
START_TEST(the_first_command_is_not_slowed) {
  double first = 0;
  for (const double begin : {0., 1000.}) {
    FollowedAxis axis;
    axis.begin();
    const FollowedAxis::Times times{begin, begin + .1};
    const AxisCommand command =
        axis.command(axis.observe(radians(20), {}, times, {}), {}, AxisLimits{-3, 3}, times, {});
    if (begin == 0) first = command.speed;
    ck_assert_double_gt(command.speed, radians(10));
    ck_assert_double_eq(command.speed, first);
  }
}
END_TEST

// Through a lens of 5 degrees an angle is as much of the picture as one 13.2 times as large through a lens of 60.
START_TEST(dead_bands_and_rest_follow_the_zoom) {
  for (const double view : {60., 0., 5.}) {
    const double scale = view == 5 ? std::tan(radians(2.5)) / std::tan(radians(30)) : 1;
    Loop loop;
    loop.parameters.field_of_view = radians(view);
    loop.target = still(10);
    loop.run(4);
    // It rests within the band of .7 degrees.
    ck_assert_double_le(std::abs(loop.error(4)), .7 * scale + .01);
    // A target that stands and goes on by half of the upper band: nothing; by twice of it: the axis follows.
    for (const double by : {1.5, 6.}) {
      Loop near;
      near.parameters.field_of_view = radians(view);
      near.target = [=](double t) { return t < 3 ? 0 : by * scale; };
      near.run(6);
      const bool follows = std::abs(near.position(6)) > .3 * scale;
      ck_assert_msg(follows == (by > 3), "%g degrees, by %g: at %g", view, by, near.position(6));
    }
  }
}
END_TEST

// A fifth of 5 degrees each 40 ms: 25 degrees a second.
START_TEST(a_long_lens_limits_the_speed_by_what_the_picture_turns) {
  Loop loop;
  loop.target = still(60);
  loop.parameters.field_of_view = radians(5);
  loop.run(4);
  double fastest = 0;
  for (const double speed : loop.commanded) fastest = std::max(fastest, std::abs(speed));
  ck_assert_double_le(fastest, 25.01);
  ck_assert_double_ge(fastest, 24);
}
END_TEST

// The same where each picture comes twice.
START_TEST(a_repeated_picture_of_a_long_lens_does_not_lift_the_limit) {
  FollowedAxis axis;
  axis.begin();
  const FollowedAxis::Parameters parameters{.field_of_view = radians(5)};
  const AxisLimits limits{-3, 3, radians(90), radians(300)};
  double fastest = 0;
  for (int k = 0; k < 50; ++k) {
    const FollowedAxis::Times times{k / 2 * .04, k * .02 + .1};
    const auto aim = axis.observe(radians(60), {}, times, parameters);
    const AxisCommand command = axis.command(aim, {}, limits, times, parameters);
    if (k >= 2) fastest = std::max(fastest, degrees(command.speed));  // one picture has no interval
  }
  ck_assert_double_le(fastest, 25.01);
  ck_assert_double_ge(fastest, 24);
}
END_TEST

// The dead time that is learnt becomes shorter, and two frames come at once.
START_TEST(an_effect_that_comes_before_the_last_one_changes_no_speed) {
  FollowedAxis axis;
  axis.begin();
  const AxisLimits limits{-3, 3, radians(90), radians(300)};
  double last = 0;
  for (int k = 0; k <= 10; ++k) {
    const double taken = k * .04, effect = k < 10 ? taken + .3 : taken + .1;
    const FollowedAxis::Times times{taken, effect};
    const AxisCommand command = axis.command(axis.observe(radians(20), {}, times, {}), {}, limits, times, {});
    if (k == 10) ck_assert_double_eq_tol(command.speed, last, radians(.1));
    last = command.speed;
  }
}
END_TEST

// A picture that is shown again and again moves no target on for ever.
START_TEST(nothing_is_predicted_where_the_axis_is_blind) {
  FollowedAxis axis;
  for (int k = 0; k <= 25; ++k) axis.observe(radians(20) * k * .04, {}, {k * .04, k * .04 + .1}, {});
  const auto aim = axis.observe(radians(20), {}, {1, 11.1, 10}, {});
  ck_assert_double_eq_tol(degrees(aim.position), 22, 1);
}
END_TEST

START_TEST(nothing_is_allocated) {
  FollowedAxis axis;
  const std::size_t before = cerberus::tests::allocations();
  for (int k = 0; k < 100; ++k) {
    const FollowedAxis::Times times{k * .04, k * .04 + .1};
    axis.command(axis.observe(k * .01, {}, times, {}), {}, AxisLimits{-3, 3}, times, {});
  }
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "followed_axis",
      {it_goes_with_a_target_and_does_not_run_after_it,
       where_the_target_is_when_the_command_takes_effect_counts, a_base_that_turns_is_no_motion_of_the_target,
       speed_acceleration_and_jerk_are_limited, it_brakes_in_time,
       it_does_not_shoot_past_a_target_that_it_catches_up_with,
       before_a_target_that_stands_it_rests_though_boxes_wander, it_starts_again_when_the_target_goes,
       calm_lags_most_and_fast_trembles_most, a_long_way_from_picture_to_effect_makes_it_slow_and_not_swing,
       a_new_target_is_centred_and_an_old_one_within_the_band_rests, the_first_command_is_not_slowed,
       dead_bands_and_rest_follow_the_zoom, a_long_lens_limits_the_speed_by_what_the_picture_turns,
       a_repeated_picture_of_a_long_lens_does_not_lift_the_limit,
       an_effect_that_comes_before_the_last_one_changes_no_speed,
       nothing_is_predicted_where_the_axis_is_blind, nothing_is_allocated});
}
