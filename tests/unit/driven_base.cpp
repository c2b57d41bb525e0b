// SPDX-License-Identifier: LGPL-2.1-or-later
// How a simulated robot drives, turns and shakes.
#include "sim/house/driven_base.h"

#include <check.h>

#include <chrono>
#include <cmath>

#include "support/suite.h"

using namespace cerberus::sim;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

// 3 m at .6 m/s and .8 m/s2: 5.75 s; 90 degrees at 45 a second and 180 a second squared: 2.25 s.
START_TEST(a_base_drives_and_turns_at_its_rates_and_rests_at_its_places) {
  DrivenBase base(
      1, 1, 0, {{Leg::drive, 4, 1, 0, .6}, {Leg::turn, 0, 0, radians(90)}, {Leg::wait, 0, 0, 0, 0, 60}}, {});
  double fastest = 0, hardest = 0, fastest_turn = 0, speed = 0, arrived = 0, turned = 0;
  for (cerberus::motion::Time t = 2ms; t < 12s; t += 2ms) {
    base.elapse(t);
    fastest = std::max(fastest, base.speed());
    fastest_turn = std::max(fastest_turn, base.yaw_rate());
    if (base.speed() > speed) hardest = std::max(hardest, (base.speed() - speed) / .002);
    speed = base.speed();
    const double now = cerberus::motion::seconds(t);
    if (arrived == 0 && base.x() > 3.99) arrived = now;
    if (turned == 0 && base.yaw() > radians(89.5)) turned = now;
  }
  ck_assert_double_eq_tol(fastest, .6, 1e-6);
  ck_assert_double_eq_tol(hardest, .8, 1e-3);
  ck_assert_double_eq_tol(degrees(fastest_turn), 45, 1e-3);
  ck_assert_double_eq_tol(arrived, 5.75, .2);
  ck_assert_double_eq_tol(turned - arrived, 2.25, .2);
  ck_assert_double_eq_tol(base.x(), 4, .01);
  ck_assert_double_eq_tol(base.y(), 1, .01);
  ck_assert_double_eq_tol(degrees(base.yaw()), 90, .3);
  ck_assert_double_eq_tol(base.yaw_rate(), 0, 1e-9);
}
END_TEST

START_TEST(a_base_turns_towards_a_place_before_it_drives_there) {
  DrivenBase base(0, 0, 0, {{Leg::drive, -2, -2, 0, 1.5}, {Leg::wait, 0, 0, 0, 0, 60}}, {});
  base.elapse(2s);
  ck_assert_double_eq_tol(std::hypot(base.x(), base.y()), 0, 1e-9);
  ck_assert_double_lt(base.yaw(), radians(-60));
  base.elapse(12s);
  ck_assert_double_eq_tol(base.x(), -2, .03);
  ck_assert_double_eq_tol(base.y(), -2, .03);
}
END_TEST

START_TEST(no_base_is_faster_than_its_kind) {
  DrivenBase base(0, 0, 0, {{Leg::turn, 0, 0, radians(300)}, {Leg::drive, 50, 0, 0, 9}},
                  {radians(200), .8, 9});
  double fastest = 0, fastest_turn = 0;
  for (cerberus::motion::Time t = 2ms; t < 20s; t += 2ms) {
    base.elapse(t);
    fastest = std::max(fastest, base.speed());
    fastest_turn = std::max(fastest_turn, std::abs(base.yaw_rate()));
  }
  ck_assert_double_eq_tol(fastest, 1.5, 1e-6);
  ck_assert_double_eq_tol(degrees(fastest_turn), 60, 1e-6);
}
END_TEST

START_TEST(a_shake_has_its_strength_and_repeats_by_its_seed) {
  const Shake one(radians(.5), 2, 8, 3), same(radians(.5), 2, 8, 3), other(radians(.5), 2, 8, 4);
  double square = 0, differs = 0;
  constexpr int kTimes = 60000;
  for (int i = 0; i < kTimes; ++i) {
    square += std::pow(one.at(i * .001), 2);
    ck_assert(one.at(i * .001) == same.at(i * .001));
    differs = std::max(differs, std::abs(one.at(i * .001) - other.at(i * .001)));
  }
  ck_assert_double_eq_tol(degrees(std::sqrt(square / kTimes)), .5, .05);
  ck_assert_double_gt(degrees(differs), .2);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "driven_base", {a_base_drives_and_turns_at_its_rates_and_rests_at_its_places,
                      a_base_turns_towards_a_place_before_it_drives_there, no_base_is_faster_than_its_kind,
                      a_shake_has_its_strength_and_repeats_by_its_seed});
}
