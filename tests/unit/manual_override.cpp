// SPDX-License-Identifier: LGPL-2.1-or-later
// The application's own command.
#include "control/manual_override.h"

#include <check.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "../support/suite.h"

using namespace cerberus;
using control::ManualOverride;
using sensing::radians;
using Kind = motion::AxisCommand::Kind;

namespace {

const motion::Limits kLimits{.pan = {radians(-60), radians(60)}, .tilt = {radians(-20), radians(20)}};

motion::Pose looking(double pan, double tilt) {
  motion::Pose pose;
  pose.pan.position = radians(pan);
  pose.tilt.position = radians(tilt);
  return pose;
}

void assert_goes(const ManualOverride& manual, double pan, double tilt) {
  ck_assert(manual.command().pan.kind == Kind::position && manual.command().tilt.kind == Kind::position);
  ck_assert_double_eq_tol(manual.command().pan.value, radians(pan), 1e-12);
  ck_assert_double_eq_tol(manual.command().tilt.value, radians(tilt), 1e-12);
}

}  // namespace

START_TEST(an_absolute_move_goes_there_whatever_the_pose) {
  ManualOverride manual;
  ck_assert(!manual.active());
  ck_assert(manual.move(radians(30), radians(-10), false, looking(5, 5), kLimits));
  ck_assert(manual.active());
  assert_goes(manual, 30, -10);
  ck_assert_str_eq(manual.reason(), "manual command: move");
}
END_TEST

START_TEST(relative_moves_add_up_from_the_pose_and_then_from_the_last_command) {
  ManualOverride manual;
  ck_assert(manual.move(radians(10), radians(1), true, looking(5, 5), kLimits));
  assert_goes(manual, 15, 6);
  ck_assert(manual.move(radians(10), radians(1), true, looking(7, 5), kLimits));  // on its way to 15
  assert_goes(manual, 25, 7);
  ck_assert(!manual.waits_for_order());
  manual.stop();
  ck_assert(manual.waits_for_order());
  ck_assert(manual.move(radians(10), radians(1), true, looking(20, 7), kLimits));
  ck_assert(!manual.waits_for_order());
  assert_goes(manual, 30, 8);
}
END_TEST

START_TEST(beyond_a_limit_the_head_goes_as_far_as_the_limit) {
  ManualOverride manual;
  ck_assert(manual.move(radians(70), radians(-21), false, {}, kLimits));
  assert_goes(manual, 60, -20);
  ck_assert_str_eq(manual.reason(), "manual command: move, as far as the limit");
}
END_TEST

START_TEST(a_number_that_is_none_changes_nothing) {
  ManualOverride manual;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ck_assert(!manual.move(nan, 0, false, {}, kLimits) && !manual.active());
  manual.move(radians(30), 0, false, {}, kLimits);
  ck_assert(!manual.move(0, 1 / 0., true, {}, kLimits));
  assert_goes(manual, 30, 0);
}
END_TEST

START_TEST(an_expired_command_stands_still_and_stays_an_override) {
  ManualOverride manual;
  manual.expire("late");  // without a command: nothing
  ck_assert(!manual.active());
  manual.move(radians(30), 0, false, {}, kLimits);
  manual.expire("late");
  ck_assert(manual.active());
  ck_assert(manual.command().pan.kind == Kind::hold && manual.command().tilt.kind == Kind::hold);
  ck_assert_str_eq(manual.reason(), "late");
  ck_assert(manual.waits_for_order());
  ck_assert(manual.end() && !manual.waits_for_order());
  manual.move(radians(30), 0, false, {}, kLimits);
  ck_assert(manual.end() && !manual.active() && !manual.end());
}
END_TEST

START_TEST(a_turn_and_a_move_with_a_deadline_become_a_stop_unless_repeated) {
  using namespace std::chrono_literals;
  ManualOverride manual;
  ck_assert(manual.turn(radians(10), 0));
  ck_assert(manual.command().pan.kind == Kind::velocity && manual.command().tilt.kind == Kind::hold);
  ck_assert_double_eq(manual.command().pan.value, radians(10));
  manual.expires(500ms);
  ck_assert(!manual.lapse(499ms));
  ck_assert(manual.turn(radians(10), 0));  // repeated
  manual.expires(900ms);
  ck_assert(!manual.lapse(500ms));
  ck_assert(manual.lapse(900ms));
  ck_assert(!manual.lapse(901ms));
  ck_assert(manual.active() && manual.command().pan.kind == Kind::hold);  // latched
  ck_assert(manual.move(radians(5), 0, false, {}, kLimits));
  ck_assert(manual.deadline() == motion::kNever);
  ck_assert(!manual.lapse(1h));
  for (const double none : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL})
    ck_assert(!manual.turn(none, 0) && !manual.turn(0, none));
  assert_goes(manual, 5, 0);
}
END_TEST

START_TEST(the_emergency_stop_takes_precedence_and_latches) {
  using control::Authority;
  ManualOverride manual;
  ck_assert(manual.authority() == Authority::automatic);
  manual.move(radians(5), 0, false, {}, kLimits);
  ck_assert(manual.authority() == Authority::manual);
  manual.emergency(true);
  ck_assert(manual.authority() == Authority::emergency_stop);
  ck_assert(manual.command().pan.kind == Kind::hold);
  ck_assert(!manual.move(radians(5), 0, false, {}, kLimits));
  ck_assert(!manual.turn(1, 0));
  ck_assert(!manual.end());
  manual.stop();
  manual.expire("over");
  ck_assert_str_eq(manual.reason(), "the emergency stop is pressed");
  ck_assert(manual.waits_for_order());
  manual.emergency(false);
  ck_assert(manual.authority() == Authority::manual);  // decisions do not have the head back
  ck_assert(manual.command().pan.kind == Kind::hold && manual.waits_for_order());
  ck_assert(manual.end());
  ck_assert(manual.authority() == Authority::automatic);
}
END_TEST

int main() {
  return tests::run_suite(
      "manual_override",
      {an_absolute_move_goes_there_whatever_the_pose,
       relative_moves_add_up_from_the_pose_and_then_from_the_last_command,
       beyond_a_limit_the_head_goes_as_far_as_the_limit, a_number_that_is_none_changes_nothing,
       an_expired_command_stands_still_and_stays_an_override,
       a_turn_and_a_move_with_a_deadline_become_a_stop_unless_repeated,
       the_emergency_stop_takes_precedence_and_latches});
}
