// SPDX-License-Identifier: LGPL-2.1-or-later
// Which reports of an axis part from its commands, in the test's own time: ten reports a second, latency 150 ms.
#include "motion/report_watch.h"

#include <cmath>
#include <functional>
#include <limits>

#include "support/suite.h"

using namespace cerberus::motion;
using namespace std::chrono_literals;
using cerberus::sensing::radians;
using Verdict = ReportWatch::Verdict;

namespace {

constexpr double kLatency = .15, kNan = std::numeric_limits<double>::quiet_NaN();

// Degrees at a time in seconds.
using Way = std::function<double(double)>;

// `speed` from 1 s on, until `end` degrees are reached.
Way turn(double speed, double end) {
  return [=](double t) {
    const double way = speed * std::max(0.0, t - 1);
    return speed > 0 ? std::min(way, end) : std::max(way, end);
  };
}

struct Rig {
  ReportWatch watch;
  double doubted = 0, parted = kNan;  // seconds of the first such report

  // Reports until it parts, 30 s at most.
  Rig& run(const Way& commanded, const Way& reported) {
    doubted = parted = kNan;
    for (int k = 0; k < 300; ++k) {
      const double t = k * .1, speed = (commanded(t + .001) - commanded(t)) / .001;
      const Verdict verdict =
          watch.add(1h + k * 100ms, radians(reported(t)), radians(commanded(t)), radians(speed), kLatency);
      if (std::isnan(doubted) && verdict != Verdict::plausible) doubted = t;
      if (verdict != Verdict::parted) continue;
      parted = t;
      break;
    }
    return *this;
  }
};

const Way kRest = [](double) { return 0.0; };

}  // namespace

// At 20 degrees a second the tolerance is 10 + 20 (.15 + .5) = 23 degrees, which both part by after .575 s, and by twice
// the time where the reports stand.
START_TEST(reversed_reports_part_a_second_after_they_have_left_the_tolerance) {
  Rig rig;
  rig.run(turn(20, 170), turn(-20, -170));
  ck_assert_double_ge(rig.parted, 2.5);
  ck_assert_double_le(rig.parted, 2.8);
}
END_TEST

START_TEST(reports_that_stand_at_zero_part) {
  Rig rig;
  rig.run(turn(20, 170), kRest);
  ck_assert_double_ge(rig.parted, 3.1);
  ck_assert_double_le(rig.parted, 3.4);
}
END_TEST

START_TEST(a_head_that_drifts_by_itself_parts) {
  for (const double speed : {3.0, -3.0, 40.0}) {
    Rig rig;
    rig.run(kRest, turn(speed, speed * 1000));
    const double out = 1 + 10 / std::abs(speed);
    ck_assert_double_ge(rig.parted, out + .9);
    ck_assert_double_le(rig.parted, out + 1.3);
  }
}
END_TEST

START_TEST(reports_far_beyond_part_and_are_not_believed_meanwhile) {
  for (const double beyond : {500.0, -500.0, 12.0}) {
    Rig rig;
    rig.run(kRest, [=](double t) { return t < 1 ? 0 : beyond; });
    ck_assert_double_eq_tol(rig.doubted, 1, .01);
    ck_assert_double_ge(rig.parted, 1.8);
    ck_assert_double_le(rig.parted, 2.2);
  }
}
END_TEST

START_TEST(reports_that_jump_to_and_fro_part_at_rest_and_while_it_turns) {
  const auto jumps = [](const Way& way, double low, double high) {
    return [=](double t) { return way(t) + (std::lround(t * 10) % 2 ? low : high); };
  };
  for (const Way& commanded : {Way(kRest), turn(20, 170)}) {
    ck_assert_double_le(Rig().run(commanded, jumps(commanded, -100, 100)).parted, 3);
    ck_assert_double_le(Rig().run(commanded, jumps(commanded, 0, 100)).parted, 5);
    ck_assert_double_le(Rig().run(commanded, jumps(commanded, 100, 150)).parted, 3);
  }
}
END_TEST

START_TEST(reports_that_are_no_numbers_part) {
  Rig rig;
  rig.run(kRest, [](double t) { return t < 1 ? 0 : kNan; });
  ck_assert_double_ge(rig.parted, 1.8);
  ck_assert_double_le(rig.parted, 2.2);
  ck_assert_double_le(Rig().run(kRest, [](double) { return kNan; }).parted, 1.2);
}
END_TEST

// Of every second they are outside for half: a quarter of what they were inside is taken back.
START_TEST(single_wrong_reports_do_not_part) {
  Rig rig;
  rig.run(kRest, [](double t) { return std::lround(t * 10) % 10 == 5 ? 90.0 : 0.0; });
  ck_assert(std::isnan(rig.parted));
  ck_assert(!std::isnan(rig.doubted));
}
END_TEST

// The head takes 5.7 s for what the commands do in 1.9; and one that is a table's factor of 1.7 too fast.
START_TEST(a_head_that_is_slower_or_faster_than_commanded_does_not_part) {
  const auto late = [](const Way& way, double delay) { return [=](double t) { return way(t - delay); }; };
  Rig rig;
  rig.run(turn(90, 170), late(turn(30, 170), .3));
  ck_assert(std::isnan(rig.parted) && std::isnan(rig.doubted));
  rig.run(turn(90, 340), late(turn(20, 340), .1));
  ck_assert(std::isnan(rig.parted));
  Rig slow;  // at 4 degrees a second the reports of half a second show it
  slow.run(turn(4, 170), late(turn(1.6, 170), .1));
  ck_assert(std::isnan(slow.parted) && std::isnan(slow.doubted));
  Rig fast;
  fast.run(turn(20, 170), late(turn(34, 289), .1));
  ck_assert_double_ge(fast.parted, 9.5);  // not while it turns: until it stands 119 degrees too far
}
END_TEST

// 4.5 times as fast as commanded, in steps that are no jumps: it runs away.
START_TEST(a_head_that_turns_much_faster_than_commanded_parts_while_it_turns) {
  Rig rig;
  rig.run(turn(10, 170), turn(45, 340));
  ck_assert_double_ge(rig.parted, 2);
  ck_assert_double_le(rig.parted, 3);
}
END_TEST

// The tolerance of a turn at 90 degrees a second, 68 degrees, ends with it.
START_TEST(after_a_fast_turn_reports_are_compared_as_closely_as_at_rest) {
  Rig rig;
  rig.run(turn(90, 90), [](double t) { return turn(90, 90)(t) + (t < 8 ? 0 : 40); });
  ck_assert_double_ge(rig.parted, 8.8);
  ck_assert_double_le(rig.parted, 9.2);
}
END_TEST

// It comes nearer for two seconds and stands then, 40 degrees off; or it never does by more than its encoder's noise; or it
// comes nearer by jumps, of which each is more than a head at rest can turn.
START_TEST(only_steady_progress_towards_the_command_counts) {
  Rig stands;
  stands.run(kRest, [](double t) { return t < 1 ? 80 : std::max(40.0, 80 - 20 * (t - 1)); });
  ck_assert_double_le(stands.parted, 4.5);
  Rig noisy;  // each report is the nearest one so far
  noisy.run(kRest, [](double t) { return 80 - .5 * t; });
  ck_assert_double_le(noisy.parted, 1.2);
  Rig creeps;
  creeps.run([](double t) { return .2 * t; }, [](double t) { return 40 + .4 * t; });
  ck_assert_double_le(creeps.parted, 1.2);
  Rig jumps;
  jumps.run(kRest, [](double t) { return std::max(0.0, 168 - 12 * std::floor(t * 10 + .5)); });
  ck_assert_double_le(jumps.parted, 1.2);
}
END_TEST

// Somebody turns the head by hand, by 60 degrees each time, and it goes back to where it is commanded to be.
START_TEST(a_head_may_go_back_to_its_place_several_times) {
  Rig rig;
  rig.run(kRest, [](double t) { return std::max(0.0, 60 - 20 * std::fmod(t, 6)); });
  ck_assert(std::isnan(rig.parted));
}
END_TEST

// Two reports a second, of a head that is 1.6 times too fast: 48 degrees from one to the next are its way.
START_TEST(a_head_that_reports_seldom_does_not_jump) {
  ReportWatch watch;
  for (int k = 0; k < 12; ++k) {
    const double commanded = radians(30 * k), reported = radians(48 * k);
    ck_assert(watch.add(1h + k * 500ms, reported, commanded, radians(60), kLatency) == Verdict::plausible);
  }
}
END_TEST

// A sine of 40 degrees in 8 s, 600 ms late where 150 are known.
START_TEST(a_head_that_is_late_does_not_part) {
  const Way swing = [](double t) { return 40 * std::sin(t * M_PI / 4); };
  Rig rig;
  rig.run(swing, [&](double t) { return swing(t - .6) + .1 * std::sin(77 * t); });
  ck_assert(std::isnan(rig.parted) && std::isnan(rig.doubted));
}
END_TEST

START_TEST(where_a_head_comes_to_rest_counts_if_it_has_followed) {
  const auto rested = [](double share) {
    Rig rig;
    rig.run(turn(30, 60), turn(30 * share, 60 * share));
    return rig.watch.take_rest(radians(60 * share), radians(60));
  };
  ck_assert(rested(1));
  ck_assert(rested(.6));
  ck_assert(rested(1.5));
  // Far from where it is commanded to be, whatever its way was; and once only for one way.
  Rig far;
  far.run(turn(30, 60), [](double t) { return turn(30, 60)(t) + 90; });
  ck_assert(!far.watch.take_rest(radians(150), radians(60)));
  Rig once;
  once.run(turn(30, 60), turn(30, 60));
  ck_assert(once.watch.take_rest(radians(60), radians(60)));
  ck_assert(!once.watch.take_rest(radians(60), radians(60)));
  // It was outside for .9 s before: that counts no more.
  Rig outside;
  outside.run(turn(30, 60), [](double t) { return turn(30, 60)(t) + (t > 29.05 ? 30 : 0); });
  ck_assert(std::isnan(outside.parted) && std::isfinite(outside.doubted));
  ck_assert(outside.watch.take_rest(radians(75), radians(60)));
  for (int k = 0; k < 4; ++k)
    ck_assert(outside.watch.add(1h + 30s + k * 100ms, radians(90), radians(60), 0, kLatency) ==
              Verdict::doubtful);
  // A shift of all commands is no way of the head.
  ReportWatch shifted;
  shifted.add(1h, 0, 0, 0, kLatency);
  shifted.shift(radians(8));
  shifted.add(1h + 100ms, radians(8), radians(8), 0, kLatency);
  ck_assert(!shifted.take_rest(radians(8), radians(8)));
  ReportWatch drifts;  // it is 20 degrees off, and goes on
  for (int k = 0; k < 8; ++k) {
    if (k == 3) drifts.shift(radians(10));
    const double reported = radians(20 + 4 * k), commanded = radians(k < 3 ? 0 : 10);
    ck_assert(drifts.add(1h + k * 100ms, reported, commanded, 0, kLatency) == Verdict::doubtful);
  }
  Rig small;  // 4 degrees each time, and the reports stand at 0
  small.watch.add(1h, 0, 0, 0, kLatency);
  for (int k = 1; k < 6; ++k) {
    for (int i = 0; i < 10; ++i) small.watch.add(1h + k * 1s + i * 100ms, 0, radians(4 * k), 0, kLatency);
    ck_assert_msg(!small.watch.take_rest(0, radians(4 * k)), "%d", k);
  }
}
END_TEST

START_TEST(angles_above_180_are_those_to_the_left_where_the_limits_say_so) {
  const AxisLimits usual{radians(-170), radians(170)}, wide{radians(-350), radians(350)};
  const auto is = [](double reported, double commanded, const AxisLimits& limits) {
    return cerberus::sensing::degrees(unwrapped(radians(reported), radians(commanded), limits));
  };
  ck_assert_double_eq_tol(is(350, 0, usual), -10, 1e-9);
  ck_assert_double_eq_tol(is(200, -150, usual), -160, 1e-9);
  ck_assert_double_eq_tol(is(10, -5, usual), 10, 1e-9);
  ck_assert_double_eq_tol(is(-90, 150, usual), -90, 1e-9);
  ck_assert_double_eq_tol(is(300, 0, wide), 300, 1e-9);  // such a head can be there
  ck_assert_double_eq_tol(is(500, 170, usual), 140, 1e-9);
  ck_assert_double_eq_tol(is(185, 170, usual), 185, 1e-9);  // 15 degrees beyond, rather than a turn back
  ck_assert_double_eq_tol(is(200, 0, {radians(-90), radians(90)}), 200,
                          1e-9);  // neither is within the limits
  ck_assert(std::isnan(unwrapped(kNan, 0, usual)));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "report_watch",
      {reversed_reports_part_a_second_after_they_have_left_the_tolerance, reports_that_stand_at_zero_part,
       a_head_that_drifts_by_itself_parts, reports_far_beyond_part_and_are_not_believed_meanwhile,
       reports_that_jump_to_and_fro_part_at_rest_and_while_it_turns, reports_that_are_no_numbers_part,
       single_wrong_reports_do_not_part, a_head_that_is_slower_or_faster_than_commanded_does_not_part,
       a_head_that_turns_much_faster_than_commanded_parts_while_it_turns,
       after_a_fast_turn_reports_are_compared_as_closely_as_at_rest,
       only_steady_progress_towards_the_command_counts, a_head_may_go_back_to_its_place_several_times,
       a_head_that_reports_seldom_does_not_jump, a_head_that_is_late_does_not_part,
       where_a_head_comes_to_rest_counts_if_it_has_followed,
       angles_above_180_are_those_to_the_left_where_the_limits_say_so});
}
