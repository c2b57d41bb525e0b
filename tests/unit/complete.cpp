// SPDX-License-Identifier: LGPL-2.1-or-later
// The computed rules are proven free of gaps by enumeration: every geometry of 1 to 8 sensors below, every set of them
// that fires, every whole degree of pan. The oracle counts directions one by one on a ring of half degrees, with whole
// numbers, without arcs.
#include "fusion/complete.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sensing/angles.h"
#include "support/geometry.h"
#include "support/suite.h"

using namespace cerberus::fusion;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::geometry;

namespace {

constexpr int kRing = 720;  // half degrees
constexpr double kHysteresis = radians(2);
constexpr std::array<int, kMaxSensors> kNoOrder{};

Interval limits(double from, double to) {
  return {radians(from), radians(to)};
}

void assert_interval(const Interval& interval, double from, double to) {
  ck_assert_double_eq_tol(degrees(interval.from), from, 1e-6);
  ck_assert_double_eq_tol(degrees(interval.to), to, 1e-6);
}

struct Case {
  std::vector<int> bearings;  // degrees
  int field_of_view;          // degrees
  int least, most;            // pan limits, degrees
};

int ring(int half_degrees) {
  return (half_degrees % kRing + kRing) % kRing;
}

class Oracle {
 public:
  explicit Oracle(const Case& the_case) : case_(the_case) {
    for (const int bearing : case_.bearings) {
      std::vector<bool> sees(kRing);
      for (int i = 0; i < kRing; ++i) {
        const int apart = ring(i - 2 * bearing);
        sees[static_cast<unsigned>(i)] = std::min(apart, kRing - apart) <= case_.field_of_view;
      }
      sees_.push_back(sees);
    }
  }

  // For every pan angle from stop to stop, in half degrees: how far to the nearest angle worth turning to at the left
  // and at the right when `fired` detect; kRing * 2 where there is none.
  struct Way {
    std::vector<int> left, right;
  };
  Way way(unsigned fired) const {
    std::vector<bool> all(kRing, true), any(kRing, false);
    for (unsigned s = 0; s < sees_.size(); ++s) {
      if (!(fired >> s & 1)) continue;
      for (unsigned i = 0; i < kRing; ++i) {
        all[i] = all[i] && sees_[s][i];
        any[i] = any[i] || sees_[s][i];
      }
    }
    const auto count = static_cast<unsigned>(2 * (case_.most - case_.least) + 1);
    std::vector<bool> wanted(count, false);
    if (std::ranges::find(all, true) != all.end()) {
      if (!mark(all, wanted)) mark_stop(all, wanted);
    } else if (!mark(any, wanted)) {
      for (unsigned s = 0; s < sees_.size(); ++s)
        if (fired >> s & 1) mark_stop(sees_[s], wanted);
    }
    Way way{std::vector<int>(count), std::vector<int>(count)};
    for (unsigned i = 0; i < count; ++i)
      way.left[i] = wanted[i] ? 0 : i > 0 ? std::min(way.left[i - 1] + 1, kRing * 2) : kRing * 2;
    for (unsigned i = count; i-- > 0;)
      way.right[i] = wanted[i] ? 0 : i + 1 < count ? std::min(way.right[i + 1] + 1, kRing * 2) : kRing * 2;
    return way;
  }

 private:
  bool looks(const std::vector<bool>& directions, int half_degrees) const {
    return directions[static_cast<unsigned>(ring(half_degrees))];
  }

  bool mark(const std::vector<bool>& directions, std::vector<bool>& wanted) const {
    bool found = false;
    for (unsigned i = 0; i < wanted.size(); ++i) {
      if (!looks(directions, 2 * case_.least + static_cast<int>(i))) continue;
      wanted[i] = found = true;
    }
    return found;
  }

  // Out of reach: how far beyond each stop?
  void mark_stop(const std::vector<bool>& directions, std::vector<bool>& wanted) const {
    int right = 0, left = 0;
    while (!looks(directions, 2 * case_.most + right)) ++right;
    while (!looks(directions, 2 * case_.least - left)) ++left;
    if (right <= left) wanted.back() = true;
    if (left <= right) wanted.front() = true;
  }

  Case case_;
  std::vector<std::vector<bool>> sees_;
};

long decisions = 0;

void prove(const Case& the_case) {
  const Geometry sensors =
      geometry({the_case.bearings.begin(), the_case.bearings.end()}, the_case.field_of_view);
  const Interval stops = limits(the_case.least, the_case.most);
  const Oracle oracle(the_case);
  for (unsigned fired = 1; fired < 1U << the_case.bearings.size(); ++fired) {
    const Oracle::Way way = oracle.way(fired);
    for (int degree = the_case.least; degree <= the_case.most; ++degree) {
      const double pan = radians(degree);
      const Places found = places(sensors, static_cast<SensorBits>(fired), pan, kNoOrder, radians(60), stops);
      const auto wrong = [&](const char* what) {
        ck_abort_msg("%s: %zu sensors, the first at %d, %d degrees wide, limits %d..%d, fired %#x, pan %d",
                     what, the_case.bearings.size(), the_case.bearings.front(), the_case.field_of_view,
                     the_case.least, the_case.most, fired, degree);
      };
      if (found.count == 0) wrong("no answer");
      for (const Place& place : found) {
        if (!(place.wanted.from >= stops.from && place.wanted.to <= stops.to)) wrong("beyond the limits");
        if (!(place.wanted.from <= place.sweep.from && place.sweep.from <= place.sweep.to &&
              place.sweep.to <= place.wanted.to))
          wrong("the sweep leaves the place");
      }
      ++decisions;

      const auto here = static_cast<unsigned>(2 * (degree - the_case.least));
      const int nearest = std::min(way.left[here], way.right[here]);
      const bool left = way.left[here] == nearest, right = way.right[here] == nearest;
      const Action action = approach(found[0], pan, false, 0);
      if (nearest == 0 && action != Action::search) wrong("does not search where it should");
      if (nearest > 0 && action == Action::search) wrong("searches elsewhere");
      if (action == Action::turn_right && !right) wrong("turns right, away from what is wanted");
      if (action == Action::turn_left && !left) wrong("turns left, away from what is wanted");

      // With hysteresis it may stop a little early and stay a little longer, and never turns away either.
      for (const bool inside : {false, true}) {
        const Action lazy = approach(found[0], pan, inside, kHysteresis);
        if (lazy != action && lazy != Action::search) wrong("hysteresis turns the head round");
        if (lazy == Action::search && nearest > (inside ? 8 : 4)) wrong("hysteresis searches elsewhere");
      }
    }
  }
}

std::vector<int> evenly(int count) {
  std::vector<int> bearings;
  for (int i = 0; i < count; ++i) bearings.push_back(static_cast<int>(std::lround(360.0 * i / count)));
  return bearings;
}

constexpr int kWidths[] = {30, 45, 60, 90, 120, 150, 180};

}  // namespace

START_TEST(every_evenly_spread_geometry_has_one_answer_everywhere) {
  decisions = 0;
  for (int count = 1; count <= 8; ++count)
    for (const int width : kWidths) prove({evenly(count), width, -170, 170});
  ck_assert_int_eq(decisions, 341L * 7 * (1 + 3 + 7 + 15 + 31 + 63 + 127 + 255));
}
END_TEST

START_TEST(every_odd_geometry_has_one_answer_everywhere) {
  const std::vector<std::vector<int>> odd{
      {0, -90, 90},                     // what the paper's rules 3 to 5 fit
      {0, 0},                           // two look the same way
      {180},                            // behind, right at the seam
      {-175, 175, 3},                   //
      {10, 20, 25, 27},                 // all on one side
      {-60, 60, 179, -1, 90},           //
      {-170, -169, 0, 1, 2, 100},       //
      {0, 13, 57, 101, 140, 190, 260},  //
      {0, 45, 90, 135, 180, 181, 182, 359},
  };
  for (const std::vector<int>& bearings : odd)
    for (const int width : kWidths) prove({bearings, width, -170, 170});
}
END_TEST

START_TEST(whatever_the_limits_there_is_one_answer_within_them) {
  const int heads[][2] = {{-180, 180}, {-90, 30}, {40, 100}, {0, 0}, {-350, 10}, {-200, 200}, {-360, 360}};
  const std::vector<int> three{0, -120, 120}, five{-175, 80, 95, 0, -60};
  for (const auto& head : heads)
    for (const int width : {30, 120, 180}) {
      prove({three, width, head[0], head[1]});
      prove({five, width, head[0], head[1]});
    }
}
END_TEST

START_TEST(one_sensor_asks_for_its_sector_pulled_in_by_half_a_lens) {
  const Places found = places(Geometry(), 0b001, radians(100), kNoOrder, radians(60), kDefaultLimits);
  ck_assert_int_eq(found.count, 1);
  assert_interval(found[0].wanted, -60, 60);
  assert_interval(found[0].sweep, -30, 30);
  ck_assert_int_eq(found[0].sensors, 1);
  ck_assert(!found[0].limited);
  ck_assert(approach(found[0], radians(100), false, kHysteresis) == Action::turn_left);
}
END_TEST

START_TEST(a_sector_narrower_than_the_lens_is_looked_at_from_its_middle) {
  const Places found = places(geometry({40}, 30), 1, 0, kNoOrder, radians(60), kDefaultLimits);
  assert_interval(found[0].wanted, 25, 55);
  assert_interval(found[0].sweep, 40, 40);
}
END_TEST

START_TEST(sensors_together_ask_for_what_they_share_and_then_for_what_each_covers) {
  const Geometry sensors = geometry({0, 60}, 90);
  const Places found = places(sensors, 0b11, radians(-20), kNoOrder, radians(20), kDefaultLimits);
  ck_assert_int_eq(found.count, 3);
  assert_interval(found[0].wanted, 15, 45);
  assert_interval(found[0].sweep, 25, 35);
  ck_assert_int_eq(found[0].sensors, 0b11);
  assert_interval(found[1].wanted, -45, 45);
  assert_interval(found[2].wanted, 15, 105);
}
END_TEST

START_TEST(sensors_that_contradict_each_other_are_visited_nearest_first) {
  const Geometry sensors = geometry({-90, 90}, 60);
  const Interval left = places(sensors, 0b11, radians(-10), kNoOrder, 0, kDefaultLimits)[0].wanted;
  assert_interval(left, -120, -60);
  const Interval right = places(sensors, 0b11, radians(10), kNoOrder, 0, kDefaultLimits)[0].wanted;
  assert_interval(right, 60, 120);
}
END_TEST

START_TEST(equally_near_sectors_go_by_the_last_to_fire_and_then_by_number) {
  const Geometry sensors = geometry({-90, 90}, 60);
  assert_interval(places(sensors, 0b11, 0, {0, 0}, 0, kDefaultLimits)[0].wanted, -120, -60);
  assert_interval(places(sensors, 0b11, 0, {3, 3}, 0, kDefaultLimits)[0].wanted, -120, -60);
  assert_interval(places(sensors, 0b11, 0, {1, 2}, 0, kDefaultLimits)[0].wanted, 60, 120);
  assert_interval(places(sensors, 0b11, 0, {2, 1}, 0, kDefaultLimits)[0].wanted, -120, -60);
}
END_TEST

START_TEST(a_sector_behind_is_reached_from_both_stops_and_reported_as_limited) {
  const Geometry sensors = geometry({180}, 120);
  const Places found = places(sensors, 1, radians(20), kNoOrder, radians(60), kDefaultLimits);
  ck_assert_int_eq(found.count, 2);
  assert_interval(found[0].wanted, 120, 170);
  assert_interval(found[0].sweep, 150, 170);
  assert_interval(found[1].wanted, -170, -120);
  assert_interval(found[1].sweep, -170, -150);
  ck_assert(found[0].limited && found[1].limited);
  // From the left half the way goes left, the whole way back if need be: never through the stop.
  ck_assert(approach(places(sensors, 1, radians(-20), kNoOrder, radians(60), kDefaultLimits)[0], radians(-20),
                     false, kHysteresis) == Action::turn_left);
}
END_TEST

START_TEST(the_stops_choose_the_way_round) {
  // Wanted -170 (one step beyond the stop at the right); the short way from 165 would pass through the stop.
  const Geometry sensors = geometry({-165}, 10);
  const Places found = places(sensors, 1, radians(165), kNoOrder, radians(10), kDefaultLimits);
  assert_interval(found[0].wanted, -170, -160);
  ck_assert(approach(found[0], radians(165), false, kHysteresis) == Action::turn_left);
  // A head that turns further has another way there.
  const Interval wide = limits(-200, 200);
  const Places other = places(sensors, 1, radians(165), kNoOrder, radians(10), wide);
  assert_interval(other[0].wanted, 190, 200);
  ck_assert(approach(other[0], radians(165), false, kHysteresis) == Action::turn_right);
}
END_TEST

START_TEST(what_is_out_of_reach_is_looked_at_from_the_nearest_stop) {
  const Interval ahead = limits(-90, 60);
  const Places right = places(geometry({120}, 40), 1, 0, kNoOrder, radians(60), ahead);
  ck_assert_int_eq(right.count, 1);
  assert_interval(right[0].wanted, 60, 60);
  ck_assert(right[0].limited);
  assert_interval(places(geometry({-150}, 40), 1, 0, kNoOrder, 0, ahead)[0].wanted, -90, -90);
  // In the middle behind: 100 degrees beyond either stop; the head takes the nearer one.
  const Geometry behind = geometry({165}, 10);
  assert_interval(places(behind, 1, radians(-20), kNoOrder, 0, ahead)[0].wanted, -90, -90);
  assert_interval(places(behind, 1, radians(-10), kNoOrder, 0, ahead)[0].wanted, 60, 60);
  // A motor does not stop exactly on a point: hysteresis is the width of the stop.
  ck_assert(approach(right[0], radians(57.9), false, kHysteresis) == Action::turn_right);
  ck_assert(approach(right[0], radians(58.1), false, kHysteresis) == Action::search);
  ck_assert(approach(right[0], radians(56.1), true, kHysteresis) == Action::search);
}
END_TEST

START_TEST(a_sensor_that_sees_all_around_makes_the_head_look_all_around) {
  const Places found = places(geometry({30}, 360), 1, radians(100), kNoOrder, radians(60), kDefaultLimits);
  ck_assert_int_eq(found.count, 1);
  assert_interval(found[0].wanted, -170, 170);
  assert_interval(found[0].sweep, -170, 170);
  ck_assert(!found[0].limited);  // 30 degrees beyond each stop are in the picture
  ck_assert(places(geometry({30}, 360), 1, 0, kNoOrder, radians(10), kDefaultLimits)[0].limited);
}
END_TEST

START_TEST(an_unknown_pan_angle_turns_nothing) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const Places found = places(Geometry(), 0b010, unknown, kNoOrder, radians(60), kDefaultLimits);
  ck_assert_int_gt(found.count, 0);
  ck_assert(approach(found[0], unknown, false, kHysteresis) == Action::search);
}
END_TEST

START_TEST(no_sensor_no_place) {
  ck_assert_int_eq(places(Geometry(), 0, 0, kNoOrder, 0, kDefaultLimits).count, 0);
  ck_assert_int_eq(places(Geometry(), 0b11000, 0, kNoOrder, 0, kDefaultLimits).count, 0);
}
END_TEST

START_TEST(an_edge_is_crossed_once) {
  Place place{};
  place.wanted = limits(10, 60);
  ck_assert(approach(place, radians(9.9), false, kHysteresis) == Action::turn_right);
  ck_assert(approach(place, radians(10.1), false, kHysteresis) == Action::search);
  ck_assert(approach(place, radians(8.1), true, kHysteresis) == Action::search);
  ck_assert(approach(place, radians(7.9), true, kHysteresis) == Action::turn_right);
  ck_assert(approach(place, radians(62.1), true, kHysteresis) == Action::turn_left);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "complete",
      {every_evenly_spread_geometry_has_one_answer_everywhere, every_odd_geometry_has_one_answer_everywhere,
       whatever_the_limits_there_is_one_answer_within_them,
       one_sensor_asks_for_its_sector_pulled_in_by_half_a_lens,
       a_sector_narrower_than_the_lens_is_looked_at_from_its_middle,
       sensors_together_ask_for_what_they_share_and_then_for_what_each_covers,
       sensors_that_contradict_each_other_are_visited_nearest_first,
       equally_near_sectors_go_by_the_last_to_fire_and_then_by_number,
       a_sector_behind_is_reached_from_both_stops_and_reported_as_limited, the_stops_choose_the_way_round,
       what_is_out_of_reach_is_looked_at_from_the_nearest_stop,
       a_sensor_that_sees_all_around_makes_the_head_look_all_around, an_unknown_pan_angle_turns_nothing,
       no_sensor_no_place, an_edge_is_crossed_once},
      200);
}
