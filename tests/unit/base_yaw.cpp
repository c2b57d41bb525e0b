// SPDX-License-Identifier: LGPL-2.1-or-later
// The yaw of the base from what is reported and what the picture shows: frames every 40 ms, degrees.
#include "control/following/base_yaw.h"

#include <check.h>

#include <cmath>

#include "support/suite.h"

using namespace cerberus::control;
using namespace std::chrono_literals;
using cerberus::motion::Time;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

constexpr Time kStep = 40ms;

struct Rig {
  BaseYaw yaw;
  Time now = 1h;

  // One frame. seen: turn of the picture less the reported one, as HeadController passes it.
  void frame(double reported, std::optional<double> seen, double pan, double reckoned, Time step = kStep) {
    now += step;
    std::optional<Turn> turn;
    if (seen) turn = Turn{radians(*seen), 0};
    yaw.on_frame(now, radians(reported), turn, {radians(pan), radians(reckoned), .06});
  }
  BaseTurn at(Time later) const { return yaw.at(now + later); }
};

}  // namespace

START_TEST(a_reported_turn_counts_at_once_and_goes_on_at_its_rate) {
  Rig rig;
  rig.frame(0, std::nullopt, 0, 0);
  rig.frame(.8, std::nullopt, 0, 0);  // 20 degrees a second
  const BaseTurn turn = rig.at(100ms);
  ck_assert_double_eq_tol(degrees(turn.taken), .8, 1e-9);
  ck_assert_double_eq_tol(degrees(turn.rate), 20, 1e-9);
  ck_assert_double_eq_tol(degrees(turn.effect), .8 + 2, 1e-9);
}
END_TEST

START_TEST(the_head_s_own_turn_is_none_of_the_base) {
  Rig rig;
  for (int k = 0; k < 50; ++k) rig.frame(0, .6, .6 * k, .6 * k);
  ck_assert_double_eq_tol(degrees(rig.at(1s).taken), 0, 1e-9);
  ck_assert_double_eq_tol(degrees(rig.at(1s).rate), 0, 1e-9);
}
END_TEST

START_TEST(what_the_picture_shows_beyond_the_head_is_the_base_and_its_rate_comes_slowly) {
  Rig rig;
  rig.frame(0, 0, 0, 0);
  rig.frame(0, .4 + .6, .6, .6);  // the head 15, the base 10 degrees a second
  ck_assert_double_eq_tol(degrees(rig.at(0s).taken), .4, 1e-9);
  ck_assert_double_lt(degrees(rig.at(0s).rate), 5);
  for (int k = 2; k < 60; ++k) rig.frame(0, .4 + .6, .6 * k, .6 * k);
  ck_assert_double_eq_tol(degrees(rig.at(0s).taken), .4 * 59, 1e-6);
  ck_assert_double_eq_tol(degrees(rig.at(0s).rate), 10, .1);
}
END_TEST

// A first-order low-pass: after its time constant 1 - 1/e of a step.
START_TEST(the_slower_the_head_the_slower_is_the_seen_rate) {
  for (const double dead_time : {.06, .3}) {
    BaseYaw yaw;
    const double constant = BaseYaw::Parameters{}.slowness * dead_time;
    Time now = 1h;
    const auto frame = [&](double seen) {
      now += 10ms;
      yaw.on_frame(now, 0, Turn{radians(seen), 0}, {0, 0, dead_time});
    };
    frame(0);
    for (int k = 0; k < std::lround(constant / .01); ++k) frame(.1);  // 10 degrees a second
    ck_assert_double_eq_tol(degrees(yaw.at(now).rate), 10 * (1 - std::exp(-1)), .01);
  }
}
END_TEST

START_TEST(after_a_pause_no_rate_is_known_and_the_yaw_goes_on) {
  Rig rig;
  rig.frame(0, std::nullopt, 0, 0);
  rig.frame(.8, std::nullopt, 0, 0);
  rig.frame(9, std::nullopt, 0, 0, 600ms);
  ck_assert_double_eq(rig.at(1s).rate, 0);
  ck_assert_double_eq_tol(degrees(rig.at(1s).taken), .8, 1e-9);
  const BaseTurn before = rig.at(1s);
  rig.yaw.on_frame(rig.now - 10ms, 1, std::nullopt, {});  // an older frame
  ck_assert_double_eq(rig.at(1s).taken, before.taken);
  rig.yaw.reset();
  ck_assert_double_eq(rig.at(1s).taken, 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "base_yaw",
      {a_reported_turn_counts_at_once_and_goes_on_at_its_rate, the_head_s_own_turn_is_none_of_the_base,
       what_the_picture_shows_beyond_the_head_is_the_base_and_its_rate_comes_slowly,
       the_slower_the_head_the_slower_is_the_seen_rate, after_a_pause_no_rate_is_known_and_the_yaw_goes_on});
}
