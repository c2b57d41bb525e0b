// SPDX-License-Identifier: LGPL-2.1-or-later
// The pipeline's end of the line protocol in the test's own time: which lines follow a command, and the pose that comes of
// the answers.
#include "drivers/helper/helper_client.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "sensing/angles.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::motion::Pose;
using cerberus::motion::seconds;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

struct Rig {
  struct Sent {
    Time time{};
    std::string line;
  };
  std::vector<Sent> sent;
  Time now{};
  HelperClient client{[this](const std::string& line) { sent.push_back({now, line}); }};

  Rig(const HeadSetup& setup, const char* ready) {
    assert_text(client.open(setup), "");
    client.begin(0s);
    sent.clear();
    client.handle(ready, 0s);
  }
  void command(const HeadCommand& command) {
    now = command.time;
    assert_text(client.accept(command), "");
    assert_text(client.execute(now), "");
  }
  void run(Time until) {
    while (now < until) {
      const Time next = client.serve(now);
      now = std::min(until, std::max(next, now + 1ms));
    }
  }
  Pose at(Time time) {
    Pose pose;
    assert_text(client.state(time, pose), "");
    return pose;
  }
  // Degrees a second of pan in a line `move`; 0: hold.
  static double speed_of(const std::string& line) {
    double speed = 0;
    return std::sscanf(line.c_str(), "move at %lf", &speed) == 1 ? speed : 0;
  }
  // Degrees that a head turns by the speeds that it was sent.
  double way() const {
    double sum = 0;
    for (std::size_t i = 0; i < sent.size(); ++i)
      sum += speed_of(sent[i].line) * seconds((i + 1 < sent.size() ? sent[i + 1].time : now) - sent[i].time);
    return sum;
  }
};

}  // namespace

// 6 degrees at 20 degrees a second, ramps of 60 degrees a second squared: a third of a second each, and none between.
START_TEST(a_head_with_speed_commands_only_brakes_at_the_target) {
  HeadSetup setup;
  setup.limits.pan.acceleration = radians(60);
  Rig rig(setup, "ready 1 velocity rate 100");
  rig.command({0s, {Kind::position, radians(6), radians(20)}, {}});
  rig.run(2s);
  double most = 0;
  for (const auto& [time, line] : rig.sent) most = std::max(most, Rig::speed_of(line));
  ck_assert_double_le(most, std::sqrt(6 * 60.0) + 1e-6);  // 18.97, where both ramps meet
  ck_assert_double_gt(most, 18.5);
  ck_assert_double_eq_tol(rig.way(), 6, 1e-3);
  assert_text(rig.sent.back().line, "move hold hold\n");
}
END_TEST

// A head with positions that carries out its speeds a quarter of a second later, as a board that plans its jogs: at 20
// degrees a second it is 5 degrees behind the model.
START_TEST(an_axis_with_positions_that_holds_does_not_creep_to_where_the_model_rests) {
  HeadSetup setup;
  setup.limits.pan = {radians(-170), radians(170), radians(90), radians(600)};
  Rig rig(setup, "ready 1 velocity feedback rate 20");
  const auto report = [&](double pan) {
    rig.client.handle("pose " + std::to_string(pan) + " 0 0 0 0", rig.now);
    rig.run(rig.now + 50ms);
  };
  rig.command({0s, {Kind::velocity, radians(20), 0}, {}});
  for (int k = 0; k < 20; ++k) report(std::max(0.0, k - 5.0));
  ck_assert_double_gt(Rig::speed_of(rig.sent.back().line), 15);
  rig.command({1s, {}, {Kind::velocity, radians(1), 0}});  // the other axis turns on
  for (int k = 0; k < 4; ++k) report(15);                  // the model brakes in 33 ms
  for (int k = 0; k < 100; ++k) {
    report(15);
    ck_assert(rig.sent.back().line.starts_with("move hold at "));
  }
  ck_assert_double_eq_tol(degrees(rig.at(rig.now).pan.position), 15, 0.01);
  setup.limits.pan.to = radians(10);  // it is beyond that
  assert_text(rig.client.limit(rig.now, setup.limits), "");
  rig.run(rig.now + 50ms);
  ck_assert_double_lt(Rig::speed_of(rig.sent.back().line), 0);
}
END_TEST

// The mean speed of its first period of 100 ms at 600 degrees a second squared is 30 degrees a second.
START_TEST(a_head_that_rests_is_sent_a_speed_with_the_command) {
  HeadSetup setup;
  setup.limits.pan.acceleration = radians(600);
  setup.latency = 150ms;
  Rig rig(setup, "ready 1 velocity rate 10");
  rig.command({1s, {Kind::velocity, radians(80), 0}, {}});
  ck_assert_uint_eq(rig.sent.size(), 1);
  ck_assert_double_eq_tol(Rig::speed_of(rig.sent[0].line), 30, 1e-6);
}
END_TEST

START_TEST(a_head_that_only_goes_to_angles_is_sent_the_end_of_each_period) {
  HeadSetup setup;
  setup.limits.pan.acceleration = radians(600);
  Rig rig(setup, "ready 1 position rate 10");
  rig.command({1s, {Kind::velocity, radians(80), 0}, {}});
  double angle = 0, speed = 0;
  ck_assert_int_eq(std::sscanf(rig.sent[0].line.c_str(), "move to %lf %lf hold", &angle, &speed), 2);
  ck_assert_double_eq_tol(angle, 3, 1e-6);
  ck_assert_double_eq_tol(speed, 30, 1e-6);
}
END_TEST

// Its lines are positions, whatever it was commanded: the model knows whether it is to turn.
START_TEST(a_head_that_only_goes_to_angles_is_to_turn_while_it_follows_a_speed) {
  Rig rig({}, "ready 1 position feedback");
  ck_assert(!rig.client.turns(1s));
  rig.command({1s, {Kind::velocity, radians(10), 0}, {}});
  rig.run(2s);
  ck_assert(rig.client.turns(2s));
  rig.command({2s, {}, {}});
  rig.run(4s);
  ck_assert(!rig.client.turns(4s));
}
END_TEST

// It stands at 30 degrees; limits of 10 degrees turn it back.
START_TEST(limits_that_come_in_move_a_head_that_rests_beyond_them) {
  HeadSetup setup;
  setup.pan = radians(30);
  Rig rig(setup, "ready 1 velocity rate 100");
  rig.command({0s, {}, {}});
  setup.limits.pan.from = radians(-10);
  setup.limits.pan.to = radians(10);
  rig.now = 100ms;
  assert_text(rig.client.limit(rig.now, setup.limits), "");
  rig.run(5s);
  ck_assert_double_eq_tol(rig.way(), -20, 0.01);
  assert_text(rig.sent.back().line, "move hold hold\n");
}
END_TEST

// 20 degrees a second are commanded, and the helper's steps make 10 of it: the head is where 10 lead.
START_TEST(the_speeds_that_a_helper_reports_are_reckoned_from_the_dead_time_on) {
  HeadSetup setup;
  setup.latency = 200ms;
  Rig rig(setup, "ready 1 velocity rate 10");
  rig.command({0s, {Kind::velocity, radians(20), 0}, {}});
  rig.client.handle("speeds 10 0 0.05", 100ms);  // in force since 50 ms
  ck_assert_double_eq(rig.at(240ms).pan.position, 0);
  ck_assert_double_eq_tol(degrees(rig.at(250ms + 2s).pan.position), 20, 1e-9);
  ck_assert_double_eq_tol(degrees(rig.at(250ms + 2s).pan.speed), 10, 1e-9);
  ck_assert(!rig.at(2s).measured);
}
END_TEST

// The head makes half of its commands, as was learnt while it turned.
START_TEST(what_is_learnt_of_speeds_counts_for_commands_and_reports_from_then_on) {
  HeadSetup setup;
  setup.latency = 200ms;
  Rig rig(setup, "ready 1 velocity rate 10");
  rig.command({0s, {Kind::velocity, radians(20), 0}, {}});
  rig.client.handle("speeds 20 0 0", 0s);
  const double before = degrees(rig.at(1s).pan.position);
  ck_assert_double_eq_tol(before, 16, 1e-9);
  rig.now = 1s;
  const cerberus::motion::SpeedMap half({{radians(90), radians(45)}});
  rig.client.learn(half, {});
  rig.client.handle("speeds 20 0 0", 800ms);  // in force from 1 s on
  ck_assert_double_eq_tol(degrees(rig.at(2s).pan.position), before + 10, 1e-9);
  ck_assert(rig.at(2s).by_speeds);
  rig.sent.clear();
  rig.command({2s, {Kind::velocity, radians(20), 0}, {}});
  ck_assert_double_ge(Rig::speed_of(rig.sent.back().line), 40);
}
END_TEST

// The model stands at the limit of 10 degrees while the head still reported 12 degrees more than the model.
START_TEST(a_correction_leads_beyond_no_limit_unless_the_head_reports_that) {
  HeadSetup setup;
  setup.limits.pan.to = radians(10);
  Rig rig(setup, "ready 1 position velocity feedback");
  rig.command({0s, {Kind::velocity, radians(20), 0}, {}});
  const double model = degrees(rig.at(250ms).pan.position);
  for (int k = 0; k < 20; ++k) rig.client.handle("pose " + std::to_string(model + 4.5) + " 0 0 0 0", 250ms);
  ck_assert_double_eq_tol(degrees(rig.at(250ms).pan.position), model + 4.5, 0.01);
  ck_assert_double_eq_tol(degrees(rig.at(740ms).pan.position), 10, 1e-9);
  for (int k = 0; k < 20; ++k) rig.client.handle("pose 13 0 0 0 0", 2s);  // it is there
  ck_assert_double_eq_tol(degrees(rig.at(2s).pan.position), 13, 0.01);
}
END_TEST

// The camera looks elsewhere when the pipeline begins, and is cut off while it turns.
START_TEST(the_pose_goes_on_from_the_last_report_when_these_cease) {
  HeadSetup setup;
  setup.latency = 100ms;
  Rig rig(setup, "ready 1 velocity feedback rate 20");
  const auto report = [&](double pan) {
    rig.client.handle("pose " + std::to_string(pan) + " 0 0 0 0", rig.now);
    rig.run(rig.now + 50ms);
  };
  for (int k = 0; k < 3; ++k) report(-47);
  ck_assert_double_eq_tol(degrees(rig.at(rig.now).pan.position), -47, 1e-6);
  ck_assert(rig.at(rig.now).measured);
  rig.command({rig.now, {Kind::velocity, radians(20), 0}, {}});
  double pan = -47;
  for (int k = 0; k < 40; ++k) report(pan += .9);  // 18 degrees a second
  double last = degrees(rig.at(rig.now).pan.position);
  ck_assert_double_eq_tol(last, pan + 1, 1.5);
  for (int k = 0; k < 100; ++k) {  // and nothing more
    rig.run(rig.now + 50ms);
    const double now = degrees(rig.at(rig.now).pan.position);
    ck_assert_double_ge(now, last);
    ck_assert_double_le(now, last + 1.01);
    last = now;
  }
  ck_assert(!rig.at(rig.now).measured);
  // It stops at its limit by what the last reports left it at.
  rig.run(rig.now + 20s);
  ck_assert_double_eq_tol(degrees(rig.at(rig.now).pan.position), 170, 0.01);
  assert_text(rig.sent.back().line, "move hold hold\n");
}
END_TEST

// Of the kinds of tests/unit/report_watch.cpp: the head is stopped, refuses what comes, and obeys again by a new order that
// was given after the fault was seen.
START_TEST(reports_that_part_from_the_commands_stop_the_head_until_a_new_order) {
  HeadSetup setup;
  setup.latency = 150ms;
  Rig rig(setup, "ready 1 velocity feedback rate 20");
  const auto report = [&](const std::string& pan) {
    rig.client.handle("pose " + pan + " 0 0 0 0", rig.now);
    rig.run(rig.now + 50ms);
  };
  rig.command({0s, {Kind::velocity, radians(20), 0}, {}});
  double reported = 0;
  while (rig.client.fault_at_rest().empty() && rig.now < 10s) {
    report(std::to_string(reported));
    reported -= rig.speed_of(rig.sent.back().line) * .05;  // reversed
  }
  ck_assert(rig.now > 1500ms && rig.now < 3s);
  const std::string fault = rig.client.fault_at_rest();
  ck_assert_msg(fault.starts_with("the head reports -") &&
                    fault.find("degrees of pan, and its commands lead to") != std::string::npos &&
                    fault.find("It was stopped, and stands until the next order") != std::string::npos,
                "%s", fault.c_str());
  assert_text(rig.sent.back().line, "stop\n");
  const HeadCommand again{rig.now, {Kind::velocity, radians(-20), 0}, {}};
  assert_text(rig.client.accept(again), "");  // a decision that was made before
  assert_text(rig.client.execute(rig.now), fault.c_str());
  rig.run(rig.now + 1s);
  assert_text(rig.sent.back().line, "stop\n");
  ck_assert(rig.client.parted());
  ck_assert(!rig.client.parted());
  HeadCommand stop{rig.now, {}, {}, true};
  assert_text(rig.client.accept(stop), "");
  assert_text(rig.client.execute(rig.now), fault.c_str());
  rig.command({rig.now, {Kind::velocity, radians(-20), 0}, {}});
  assert_text(rig.client.fault_at_rest(), "");
  rig.run(rig.now + 100ms);
  ck_assert_double_lt(Rig::speed_of(rig.sent.back().line), -10);
}
END_TEST

START_TEST(a_pose_that_is_no_number_is_a_fault_and_no_pose) {
  Rig rig({}, "ready 1 velocity feedback rate 20");
  rig.client.handle("pose 3 0 0 0 0", 0s);
  for (; rig.client.fault_at_rest().empty() && rig.now < 10s; rig.run(rig.now + 50ms))
    rig.client.handle("pose nan nan 0 0 0", rig.now);
  ck_assert(rig.now > 900ms && rig.now < 1500ms);
  ck_assert(rig.client.fault_at_rest().starts_with("the head reports no number as pan"));
  ck_assert_double_eq_tol(degrees(rig.at(rig.now).pan.position), 3, 1e-9);
}
END_TEST

START_TEST(a_head_that_works_again_is_where_it_reports_to_be) {
  Rig rig({}, "ready 1 velocity feedback rate 20");
  const auto report = [&](double pan) {
    rig.client.handle("pose " + std::to_string(pan) + " 0 0 0 0", rig.now);
    rig.run(rig.now + 50ms);
  };
  for (int k = 0; k < 20; ++k) report(40);
  rig.client.handle("fault no power", rig.now);
  for (int k = 0; k < 60; ++k) report(40);
  rig.client.handle("recovered", rig.now);
  for (int k = 0; k < 60; ++k) report(0);  // it has found its home meanwhile
  assert_text(rig.client.fault_at_rest(), "");
  ck_assert_double_eq_tol(degrees(rig.at(rig.now).pan.position), 0, 1e-6);
}
END_TEST

// It stands where it was left until a command moves it, which leads back.
START_TEST(a_head_that_is_beyond_its_limits_at_the_start_is_no_fault_and_does_not_move_by_itself) {
  HeadSetup setup;
  setup.limits.pan.to = radians(60);
  Rig rig(setup, "ready 1 velocity feedback rate 20");
  double pan = 100;
  const auto report = [&] {
    pan += rig.sent.empty() ? 0 : Rig::speed_of(rig.sent.back().line) * .05;
    rig.client.handle("pose " + std::to_string(pan) + " 0 0 0 0", rig.now);
    rig.run(rig.now + 50ms);
    assert_text(rig.client.fault_at_rest(), "");
  };
  for (int k = 0; k < 60; ++k) report();
  rig.command({rig.now, {}, {}});
  for (int k = 0; k < 60; ++k) report();
  ck_assert_double_eq(pan, 100);
  ck_assert_double_eq_tol(degrees(rig.at(rig.now).pan.position), 100, 0.01);
  rig.command({rig.now, {Kind::velocity, radians(20), 0}, {}});
  for (int k = 0; k < 100; ++k) report();
  ck_assert_double_eq_tol(pan, 60, 1);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "helper_client",
      {a_head_with_speed_commands_only_brakes_at_the_target,
       a_head_that_rests_is_sent_a_speed_with_the_command,
       an_axis_with_positions_that_holds_does_not_creep_to_where_the_model_rests,
       a_head_that_only_goes_to_angles_is_sent_the_end_of_each_period,
       a_head_that_only_goes_to_angles_is_to_turn_while_it_follows_a_speed,
       limits_that_come_in_move_a_head_that_rests_beyond_them,
       the_pose_goes_on_from_the_last_report_when_these_cease,
       reports_that_part_from_the_commands_stop_the_head_until_a_new_order,
       a_pose_that_is_no_number_is_a_fault_and_no_pose, a_head_that_works_again_is_where_it_reports_to_be,
       a_head_that_is_beyond_its_limits_at_the_start_is_no_fault_and_does_not_move_by_itself,
       the_speeds_that_a_helper_reports_are_reckoned_from_the_dead_time_on,
       what_is_learnt_of_speeds_counts_for_commands_and_reports_from_then_on,
       a_correction_leads_beyond_no_limit_unless_the_head_reports_that});
}
