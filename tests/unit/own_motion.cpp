// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/own_motion.h"

#include <check.h>

#include <limits>

#include "support/suite.h"

using namespace cerberus::sensing;
using namespace std::chrono_literals;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Arc field(double bearing, double width) {
  return {wrap(radians(bearing - width / 2)), radians(width)};
}

// Seconds at a time, on and off.
struct Sensor {
  PulseDoubt doubt;
  bool high = false, moves = false;

  bool is_sure(Time time) {
    doubt.update(time, high, moves);
    return !doubt.doubtful();
  }
  bool at(Time time, bool output, bool body_moves) {
    high = output;
    moves = body_moves;
    return is_sure(time);
  }
};

START_TEST(a_turn_passes_every_sensor_at_its_own_rate) {
  for (const double bearing : {0., 90., -120., 180.})
    for (const double rate : {45., -45.})
      ck_assert_double_eq_tol(degrees(passing_rate(field(bearing, 60), {radians(rate), kNan})), 45, 1e-9);
  ck_assert_double_eq(passing_rate(field(0, 60), {}), 0);
  ck_assert_double_eq(passing_rate(field(0, 60), {kNan, 0}), 0);
}
END_TEST

// v sin b / d: at a metre a second past things 2 m aside half a radian a second, 30 degrees ahead half of that.
START_TEST(a_straight_way_passes_the_sides_faster_than_what_lies_ahead) {
  for (const double speed : {1., -1.}) {
    const BodyMotion straight{kNan, speed};
    ck_assert_double_eq_tol(passing_rate(field(90, 60), straight), .5, 1e-9);
    ck_assert_double_eq_tol(passing_rate(field(-100, 60), straight), .5, 1e-9);
    ck_assert_double_eq_tol(passing_rate(field(0, 60), straight), .25, 1e-9);
    ck_assert_double_eq_tol(passing_rate(field(180, 60), straight), .25, 1e-9);
    ck_assert_double_eq_tol(passing_rate(field(0, 200), straight), .5, 1e-9);
    ck_assert_double_eq_tol(passing_rate(field(0, 360), straight), .5, 1e-9);
  }
  ck_assert_double_eq_tol(passing_rate(field(90, 60), {radians(-10), 1}), .5 + radians(10), 1e-9);
}
END_TEST

START_TEST(of_a_body_that_stands_every_detection_is_sure) {
  Sensor sensor;
  ck_assert(sensor.at(0s, true, false));
  ck_assert(sensor.doubt.due() == kNever);
  ck_assert(sensor.is_sure(100s));
  ck_assert(sensor.at(101s, false, false));
  ck_assert(sensor.at(102s, true, false));
}
END_TEST

START_TEST(a_rise_while_the_body_moves_is_doubtful_until_it_has_stood) {
  Sensor sensor;
  sensor.at(10s, false, true);
  ck_assert(!sensor.at(11s, true, true));
  ck_assert(sensor.doubt.due() == kNever);
  ck_assert(!sensor.at(12s, true, false));
  ck_assert(sensor.doubt.due() == 15s);  // no module holds it longer
  ck_assert(!sensor.is_sure(15s - 1ns));
  ck_assert(sensor.is_sure(15s));
  ck_assert(sensor.doubt.due() == kNever);
}
END_TEST

START_TEST(a_rise_counts_again_soon_after_the_motion) {
  Sensor sensor;
  sensor.at(10s, false, true);
  sensor.at(11s, true, true);
  sensor.at(12s, false, false);
  ck_assert(!sensor.at(12s + PulseDoubt::kSettle - 1ns, true, false));  // the module answers late
  sensor.at(12s + PulseDoubt::kSettle - 1ns, false, false);
  ck_assert(sensor.at(12s + PulseDoubt::kSettle, true, false));
  ck_assert(sensor.doubt.due() == kNever);  // from 15 s on nothing else holds it
  ck_assert(sensor.is_sure(20s));
}
END_TEST

START_TEST(a_detection_from_before_a_motion_stays_sure_as_long_as_a_module_holds_it) {
  Sensor sensor;
  sensor.at(1s, true, false);
  ck_assert(sensor.at(10s, true, true));
  ck_assert(sensor.doubt.due() == 13s);
  ck_assert(sensor.is_sure(13s - 1ns));
  ck_assert(!sensor.is_sure(13s));  // now the motion may hold it
  ck_assert(sensor.doubt.due() == kNever);
  sensor.at(14s, true, false);
  ck_assert(sensor.doubt.due() == 17s);
  ck_assert(sensor.is_sure(17s));
}
END_TEST

START_TEST(a_rise_between_two_motions_does_not_count_for_ever) {
  Sensor sensor;
  sensor.at(10s, false, true);
  sensor.at(11s, false, false);
  ck_assert(sensor.at(12s, true, false));
  ck_assert(sensor.at(13s, true, true));
  ck_assert(sensor.doubt.due() == 15s);
  ck_assert(!sensor.is_sure(15s));
  ck_assert(!sensor.at(16s, true, false));
  ck_assert(!sensor.at(18s, true, true));  // the next one
  ck_assert(!sensor.is_sure(20s));
}
END_TEST

START_TEST(a_new_detection_is_judged_by_itself) {
  Sensor sensor;
  sensor.at(1s, true, false);
  sensor.at(10s, true, true);
  sensor.at(11s, false, true);
  ck_assert(!sensor.at(11500ms, true, true));
}
END_TEST

START_TEST(times_do_not_go_back) {
  Sensor sensor;
  sensor.at(10s, true, true);
  sensor.at(5s, true, false);
  ck_assert(sensor.doubt.due() == 13s);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "own_motion",
      {a_turn_passes_every_sensor_at_its_own_rate,
       a_straight_way_passes_the_sides_faster_than_what_lies_ahead,
       of_a_body_that_stands_every_detection_is_sure,
       a_rise_while_the_body_moves_is_doubtful_until_it_has_stood, a_rise_counts_again_soon_after_the_motion,
       a_detection_from_before_a_motion_stays_sure_as_long_as_a_module_holds_it,
       a_rise_between_two_motions_does_not_count_for_ever, a_new_detection_is_judged_by_itself,
       times_do_not_go_back});
}
