// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/head_limits.h"

#include <check.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::motion;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

AxisLimits span(double from, double to) {
  return {radians(from), radians(to)};
}

void assert_refused(const Limits& limits, const char* part) {
  const std::string wrong = check(limits);
  ck_assert_msg(wrong.find(part) != std::string::npos, "'%s' does not say '%s'", wrong.c_str(), part);
}

void assert_reach(const AxisLimits& limits, double bearing, double position, double expected, bool limited) {
  const Reach to = reach(radians(bearing), radians(position), limits);
  ck_assert_double_eq_tol(degrees(to.position), expected, 1e-9);
  ck_assert_int_eq(to.limited, limited);
}

}  // namespace

START_TEST(what_a_head_can_do_is_accepted) {
  assert_text(check(Limits{}), "");
  assert_text(check({span(0, 0), span(0, 90)}), "");  // zero at the border; an axis that stands
}
END_TEST

START_TEST(limits_that_exclude_zero_are_refused_and_named) {
  assert_refused({span(10, 90), {}}, "pan-min 10 and pan-max 90 exclude 0");
  assert_refused({span(-90, -10), {}}, "pan-min -90 and pan-max -10 exclude 0");
  assert_refused({span(-90, 90), span(5, 30)}, "tilt-min 5 and tilt-max 30 exclude 0");
}
END_TEST

START_TEST(absurd_limits_are_refused_and_named) {
  assert_refused({span(90, -90), {}}, "wrong order");
  assert_refused({span(-1e6, 90), {}}, "beyond any head");
  assert_refused({span(kNan, 90), {}}, "beyond any head");
  Limits limits;
  for (const double speed : {0.0, -3.0, 1e9, kNan}) {
    limits.pan.speed = speed;
    assert_refused(limits, "pan speed");
  }
  limits = {};
  for (const double acceleration : {0.0, -3.0, 1e12, kNan}) {
    limits.tilt.acceleration = acceleration;
    assert_refused(limits, "tilt acceleration");
  }
}
END_TEST

START_TEST(a_bearing_within_the_stops_is_where_it_is) {
  const AxisLimits limits = span(-170, 170);
  assert_reach(limits, 30, -100, 30, false);
  assert_reach(limits, 30 + 720, -100, 30, false);
  assert_reach(limits, 170, 0, 170, false);
}
END_TEST

// From 165 to -165 the short arc (30 degrees) leads through the stop: the way round is 330 degrees long.
START_TEST(the_limits_decide_the_way_round) {
  assert_reach(span(-170, 170), -165, 165, -165, false);
  // A head of more than a turn takes the near one of two places: -165 is 195 as well.
  assert_reach(span(-200, 200), -165, 165, 195, false);
  assert_reach(span(-200, 200), -165, -10, -165, false);
}
END_TEST

START_TEST(a_bearing_beyond_the_stops_ends_at_the_nearest_one) {
  const AxisLimits limits = span(-170, 170);
  assert_reach(limits, 175, -160, 170, true);  // 5 degrees from one stop, 15 from the other
  assert_reach(limits, -175, 160, -170, true);
  assert_reach(limits, 180, 10, 170, true);  // 10 from both: the one nearer to the head
  assert_reach(limits, 180, -10, -170, true);
  assert_reach(span(-30, 60), 150, 0, 60, true);  // 90 away against 180
}
END_TEST

START_TEST(no_bearing_leads_beyond_a_stop) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-20, 20), side(0, 7);
  for (int k = 0; k < 20000; ++k) {
    const AxisLimits limits{-side(random), side(random)};
    const double bearing = angle(random);
    const Reach to = reach(bearing, angle(random), limits);
    ck_assert(limits.holds(to.position));
    // Not limited: it looks along the bearing.
    if (!to.limited) ck_assert_double_eq_tol(std::cos(to.position - bearing), 1, 1e-9);
  }
}
END_TEST

START_TEST(limits_beyond_what_a_head_reaches_are_named) {
  const AxisLimits limits = span(-170, 45);
  assert_text(beyond_reach("pan", limits, radians(-170), radians(45), "the camera"), "");
  assert_text(beyond_reach("pan", limits, radians(-200), radians(200), "the camera"), "");
  assert_text(beyond_reach("tilt", limits, radians(-160), radians(45), "the camera", " (range)"),
              "tilt-min -170 and tilt-max 45 are beyond what the camera reaches, -160 to 45 (range): set "
              "tilt-min and "
              "tilt-max");
  ck_assert(!beyond_reach("pan", limits, radians(-170), radians(44), "the camera").empty());
}
END_TEST

START_TEST(what_is_no_number_moves_nothing) {
  const AxisLimits limits = span(-170, 170);
  assert_reach(limits, kNan, 20, 20, false);
  assert_reach(limits, HUGE_VAL, 20, 20, false);
  assert_reach(limits, 30, kNan, 30, false);
  ck_assert_double_eq(limits.clamp(kNan), 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "head_limits", {what_a_head_can_do_is_accepted, limits_that_exclude_zero_are_refused_and_named,
                      absurd_limits_are_refused_and_named, a_bearing_within_the_stops_is_where_it_is,
                      the_limits_decide_the_way_round, a_bearing_beyond_the_stops_ends_at_the_nearest_one,
                      no_bearing_leads_beyond_a_stop, limits_beyond_what_a_head_reaches_are_named,
                      what_is_no_number_moves_nothing});
}
