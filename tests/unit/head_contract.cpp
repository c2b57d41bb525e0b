// SPDX-License-Identifier: LGPL-2.1-or-later
// What every head driver promises, whatever it drives. A new driver adds a line to kDrivers.
#include "drivers/head/head.h"

#include <check.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>

#include "support/text.h"

using namespace cerberus::motion;
using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = AxisCommand::Kind;

namespace {

constexpr const char* kDrivers[] = {"simulated", "scripted", "external"};

HeadSetup setup() {
  HeadSetup setup;
  setup.latency = 60ms;
  setup.command = "sh -c 'read hello; echo ready 1 position velocity; cat >/dev/null'";  // of external
  return setup;
}

struct Opened {
  std::unique_ptr<Head> head;
  explicit Opened(int driver, const HeadSetup& with = setup()) : head(make_head(kDrivers[driver])) {
    ck_assert_ptr_nonnull(head.get());
    const std::string wrong = head->open(with);
    ck_assert_str_eq(wrong.c_str(), "");
  }
  void command(Time time, const AxisCommand& pan, const AxisCommand& tilt = {}) {
    const std::string wrong = head->command({time, pan, tilt});
    ck_assert_str_eq(wrong.c_str(), "");
  }
  Pose at(Time time) {
    Pose pose;
    const std::string wrong = head->state(time, pose);
    ck_assert_str_eq(wrong.c_str(), "");
    ck_assert_int_eq(pose.from.count(), time.count());
    ck_assert(pose.until > time);
    return pose;
  }
};

}  // namespace

START_TEST(a_head_starts_at_rest_at_the_given_position) {
  HeadSetup there = setup();
  there.pan = 0.5;
  there.tilt = -0.25;
  Opened head(_i, there);
  const Pose pose = head.at(0s);
  ck_assert_double_eq_tol(pose.pan.position, 0.5, 1e-12);
  ck_assert_double_eq_tol(pose.tilt.position, -0.25, 1e-12);
  ck_assert(!pose.moving());
  ck_assert(pose.settled);
}
END_TEST

START_TEST(a_head_goes_where_it_is_sent_and_settles) {
  Opened head(_i);
  head.command(1s, {Kind::position, 1, 1}, {Kind::position, -0.5, 1});
  const Pose pose = head.at(30s);
  ck_assert_double_eq_tol(pose.pan.position, 1, 1e-6);
  ck_assert_double_eq_tol(pose.tilt.position, -0.5, 1e-6);
  ck_assert(pose.settled);
}
END_TEST

START_TEST(a_velocity_ends_at_the_stop_at_the_latest) {
  Opened head(_i);
  head.command(0s, {Kind::velocity, -100, 0}, {Kind::velocity, 100, 0});
  const Pose pose = head.at(600s);
  ck_assert_double_eq_tol(pose.pan.position, setup().limits.pan.from, 1e-6);
  ck_assert_double_eq_tol(pose.tilt.position, setup().limits.tilt.to, 1e-6);
}
END_TEST

START_TEST(no_command_leads_beyond_a_limit) {
  Opened head(_i);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-20, 20);
  for (int k = 0; k < 500; ++k) {
    const Time now = k * 70ms;
    head.command(now, {static_cast<Kind>(k % 3), number(random), number(random)},
                 {static_cast<Kind>(k / 3 % 3), number(random), number(random)});
    for (Time t = now; t < now + 70ms; t += 10ms) {
      const Pose pose = head.at(t);
      ck_assert(setup().limits.pan.holds(pose.pan.position));
      ck_assert(setup().limits.tilt.holds(pose.tilt.position));
    }
  }
}
END_TEST

START_TEST(what_was_commanded_goes_on_within_other_limits) {
  for (const AxisCommand& command : {AxisCommand{Kind::position, 2, 1}, AxisCommand{Kind::velocity, 1, 0}}) {
    Opened head(_i);
    head.command(0s, command, command);
    Limits narrow;
    narrow.pan.to = 0.5;
    narrow.tilt.to = 0.25;
    for (const Time later : {1s, 31s}) {  // on the way, or at the stop; and once more
      ck_assert(head.head->limit(later, narrow).empty());
      ck_assert_double_eq_tol(head.at(later + 29s).pan.position, 0.5, 1e-9);
      ck_assert_double_eq_tol(head.at(later + 29s).tilt.position, 0.25, 1e-9);
    }
    ck_assert(head.head->limit(61s, {}).empty());
    ck_assert_double_eq_tol(head.at(90s).pan.position, command.kind == Kind::position ? 2 : Limits{}.pan.to,
                            1e-9);
  }
}
END_TEST

START_TEST(a_head_beyond_a_new_limit_returns_to_it) {
  for (const double side : {-1.0, 1.0}) {
    Opened head(_i);
    head.command(0s, {Kind::position, side * 2, 5}, {Kind::position, side * 0.6, 5});
    head.head->stop(10s);
    const Limits narrow{.pan = {-0.5, 0.5, 1, 2}, .tilt = {-0.25, 0.25, 1, 2}};
    ck_assert(head.head->limit(20s, narrow).empty());
    Pose last = head.at(20s);
    for (Time t = 20s; t < 30s; t += 10ms) {
      const Pose pose = head.at(t);
      ck_assert(std::abs(pose.pan.position) <= std::abs(last.pan.position) + 1e-12);
      ck_assert(std::abs(pose.tilt.position) <= std::abs(last.tilt.position) + 1e-12);
      last = pose;
    }
    ck_assert_double_eq_tol(last.pan.position, side * 0.5, 1e-9);
    ck_assert_double_eq_tol(last.tilt.position, side * 0.25, 1e-9);
  }
}
END_TEST

START_TEST(new_limits_make_no_command_stale_that_comes_with_them) {
  Opened head(_i);
  ck_assert(head.head->limit(5s, {}).empty());
  ck_assert(head.head->limit(4s, {}).empty());                                    // late, and safe
  ck_assert(!head.head->command({4500ms, {Kind::position, -1, 1}, {}}).empty());  // stale
  head.command(5s, {Kind::position, 1, 1});
  ck_assert_double_eq_tol(head.at(30s).pan.position, 1, 1e-6);
}
END_TEST

START_TEST(numbers_that_are_none_move_nothing) {
  HeadSetup there = setup();
  there.pan = 0.5;
  Opened head(_i, there);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {nan, HUGE_VAL, -HUGE_VAL})
    for (const Kind kind : {Kind::position, Kind::velocity}) {
      head.command(1s, {kind, value, 1});
      ck_assert_double_eq_tol(head.at(60s).pan.position, 0.5, 1e-9);
    }
}
END_TEST

START_TEST(stop_stops_and_may_be_repeated) {
  Opened head(_i);
  head.command(0s, {Kind::velocity, 0.5, 0});
  head.head->stop(1s);
  head.head->stop(1s);
  head.head->stop(0s);  // late, and safe
  // What is stale stays so.
  ck_assert(!head.head->command({500ms, {Kind::position, 1, 1}, {}}).empty());
  const Pose pose = head.at(20s);
  ck_assert(!pose.moving());
  ck_assert_double_eq_tol(head.at(90s).pan.position, pose.pan.position, 1e-12);
  head.command(100s, {Kind::position, 0, 1});  // and it obeys again
  ck_assert_double_eq_tol(head.at(190s).pan.position, 0, 1e-6);
}
END_TEST

START_TEST(a_stale_command_is_refused_and_changes_nothing) {
  Opened head(_i);
  head.command(2s, {Kind::position, 1, 1});
  const std::string refusal = head.head->command({1s, {Kind::position, -1, 1}, {}});
  ck_assert_msg(refusal.find("stale") != std::string::npos, "'%s'", refusal.c_str());
  ck_assert_double_eq_tol(head.at(60s).pan.position, 1, 1e-6);
}
END_TEST

START_TEST(limits_that_exclude_zero_are_refused) {
  const auto head = make_head(kDrivers[_i]);
  HeadSetup wrong = setup();
  wrong.limits.pan.from = radians(10);
  ck_assert(head->open(wrong).find("exclude 0") != std::string::npos);
  wrong = setup();
  wrong.tilt = wrong.limits.tilt.to + 0.1;
  ck_assert(head->open(wrong).find("start-tilt") == 0);
  wrong = setup();
  wrong.pan = radians(175);
  assert_text(head->open(wrong), "start-pan 175 is not between pan-min -170 and pan-max 170");
  Pose pose;
  ck_assert(!head->state(0s, pose).empty());
}
END_TEST

START_TEST(a_head_that_is_not_open_is_safe_and_returns_an_error) {
  const auto head = make_head(kDrivers[_i]);
  head->stop(0s);
  head->close();
  Pose pose;
  ck_assert(head->command({}).find("not open") != std::string::npos);
  ck_assert(head->limit(0s, {}).find("not open") != std::string::npos);
  ck_assert(head->state(0s, pose).find("not open") != std::string::npos);
  assert_text(head->open(setup()), "");
  head->close();
  head->close();
  head->stop(0s);
  ck_assert(!head->command({}).empty());
  assert_text(head->open(setup()), "");  // and again
  assert_text(head->command({}), "");
}
END_TEST

START_TEST(drivers_are_known_by_their_names) {
  ck_assert_ptr_null(make_head("nonsense").get());
  ck_assert_ptr_null(make_head("").get());
  for (const char* name : kDrivers) ck_assert(head_drivers().find(name) != std::string::npos);
}
END_TEST

int main() {
  Suite* suite = suite_create("head_contract");
  TCase* cases = tcase_create("each driver");
  for (const TTest* test :
       {a_head_starts_at_rest_at_the_given_position, a_head_goes_where_it_is_sent_and_settles,
        a_velocity_ends_at_the_stop_at_the_latest, no_command_leads_beyond_a_limit,
        what_was_commanded_goes_on_within_other_limits, a_head_beyond_a_new_limit_returns_to_it,
        new_limits_make_no_command_stale_that_comes_with_them, numbers_that_are_none_move_nothing,
        stop_stops_and_may_be_repeated, a_stale_command_is_refused_and_changes_nothing,
        limits_that_exclude_zero_are_refused, a_head_that_is_not_open_is_safe_and_returns_an_error})
    tcase_add_loop_test(cases, test, 0, std::size(kDrivers));
  tcase_add_test(cases, drivers_are_known_by_their_names);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
