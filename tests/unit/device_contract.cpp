// SPDX-License-Identifier: LGPL-2.1-or-later
// What every driver of a real head promises to the helper process, whatever it drives. Each driver runs with a plant of
// its own, which derives the head's angle from what was written to the hardware: edges of lines, pulse widths, controls.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "drivers/head/emergency_stop.h"
#include "support/head_plants.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace cerberus::motion;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using cerberus::tests::CameraPlant;
using cerberus::tests::FakeLines;
using cerberus::tests::FakePort;
using cerberus::tests::HeadPlant;
using cerberus::tests::ServoPlant;
using cerberus::tests::StepperPlant;
using Kind = AxisCommand::Kind;

namespace {

std::unique_ptr<HeadPlant> make_plant(int index) {
  if (index == 0) return std::make_unique<StepperPlant>();
  if (index == 1) return std::make_unique<ServoPlant>();
  auto camera = std::make_unique<CameraPlant>();
  camera->reports = index == 2;
  return camera;
}
constexpr int kPlants = 4;
constexpr double kHair = 1e-3;  // degrees: a pulse is a whole number of nanoseconds

HeadSetup setup() {
  HeadSetup setup;
  setup.limits.pan = {radians(-100), radians(120), radians(50), radians(500)};
  setup.limits.tilt = {radians(-30), radians(30), radians(50), radians(500)};
  return setup;
}

struct Rig {
  std::unique_ptr<HeadPlant> plant;
  HeadDevice& head;
  Time now{};
  double least = 0, most = 0;
  std::optional<PoseLine> pose;

  explicit Rig(int index, const HeadSetup& with = setup()) : plant(make_plant(index)), head(plant->device()) {
    assert_text(head.open(with, now), "");
    plant->elapse(now);
  }
  void move(const AxisCommand& pan, const AxisCommand& tilt = {}) { head.move(pan, tilt, now); }
  void run(Time length) {
    for (const Time end = now + length; now < end;) {
      const Time next = head.tick(now);
      ck_assert(next > now || next + 1ms > now);
      plant->elapse(now);
      if (const auto came = head.take_pose(now)) pose = came;
      least = std::min(least, plant->pan());
      most = std::max(most, plant->pan());
      now = std::min(end, std::max(next, now + 1us));
    }
    plant->elapse(now);
  }
};

}  // namespace

START_TEST(an_open_head_stands_and_a_move_arrives_within_its_precision) {
  Rig rig(_i);
  rig.run(1s);
  ck_assert_double_eq(rig.plant->pan(), 0);
  for (const double target : {90.0, -45.0, 0.0}) {
    rig.move({Kind::position, radians(target), radians(50)});
    rig.run(6s);
    ck_assert_double_eq_tol(rig.plant->pan(), target, rig.plant->precision());
  }
  assert_text(rig.head.fault(), "");
}
END_TEST

START_TEST(a_speed_is_kept_and_ends_at_the_limit) {
  Rig rig(_i);
  rig.move({Kind::velocity, radians(20), 0});
  rig.run(1s);
  const double there = rig.plant->pan();
  rig.run(2s);
  ck_assert_double_eq_tol(rig.plant->pan() - there, 40, 0.5);
  rig.run(10s);
  ck_assert_double_eq_tol(rig.plant->pan(), 120, rig.plant->precision());
  ck_assert(rig.most <= 120 + kHair);
}
END_TEST

START_TEST(no_command_leads_beyond_a_limit) {
  Rig rig(_i);
  std::mt19937 random(11);
  std::uniform_real_distribution<double> number(-20, 20);
  for (int k = 0; k < 200; ++k) {
    rig.move({static_cast<Kind>(k % 3), number(random), number(random)},
             {static_cast<Kind>(k / 3 % 3), number(random), number(random)});
    rig.run(70ms);
  }
  ck_assert_double_ge(rig.least, -100 - kHair);
  ck_assert_double_le(rig.most, 120 + kHair);
}
END_TEST

START_TEST(other_limits_hold_at_once_and_a_head_beyond_them_returns) {
  Rig rig(_i);
  rig.move({Kind::position, radians(80), radians(50)});
  rig.run(3s);
  Limits narrow = setup().limits;
  narrow.pan.from = radians(-10);
  narrow.pan.to = radians(30);
  rig.head.limit(narrow, rig.now);
  rig.run(3s);
  ck_assert_double_eq_tol(rig.plant->pan(), 30, rig.plant->precision());
  rig.move({Kind::position, radians(-80), radians(50)});
  rig.run(3s);
  ck_assert_double_eq_tol(rig.plant->pan(), -10, rig.plant->precision());
}
END_TEST

START_TEST(a_stop_ends_all_motion_within_half_a_second_and_may_be_repeated) {
  HeadSetup slow = setup();
  slow.limits.pan.acceleration = radians(30);  // would brake for 1.6 s
  Rig rig(_i, slow);
  rig.move({Kind::velocity, radians(50), 0});
  rig.run(2s);
  ck_assert(rig.plant->pan() > 20);
  rig.head.stop(rig.now);
  rig.run(100ms);
  rig.head.stop(rig.now);
  rig.run(400ms);
  ck_assert(!rig.head.stopping());
  const double there = rig.plant->pan();
  rig.run(5s);
  ck_assert_double_eq(rig.plant->pan(), there);
  rig.move({Kind::position, 0, radians(50)});  // and it obeys again
  rig.run(9s);
  ck_assert_double_eq_tol(rig.plant->pan(), 0, rig.plant->precision());
}
END_TEST

START_TEST(numbers_that_are_none_move_nothing) {
  Rig rig(_i);
  for (const double none : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL})
    for (const Kind kind : {Kind::position, Kind::velocity}) {
      rig.move({kind, none, 1}, {kind, none, 1});
      rig.run(200ms);
      rig.move({Kind::position, 1, none});
      rig.run(200ms);
    }
  ck_assert_double_eq_tol(rig.least, 0, rig.plant->precision());
  ck_assert_double_eq_tol(rig.most, 0, rig.plant->precision());
}
END_TEST

START_TEST(feedback_is_where_the_head_is) {
  Rig rig(_i);
  if (!rig.head.abilities().feedback) return;
  rig.move({Kind::position, radians(70), radians(50)});
  rig.run(4s);
  ck_assert(rig.pose);
  ck_assert_double_eq_tol(degrees(rig.pose->pan.position), rig.plant->pan(), rig.plant->precision());
}
END_TEST

START_TEST(a_head_that_vanishes_at_rest_is_reported_within_a_second_and_used_again) {
  Rig rig(_i);
  rig.move({Kind::position, radians(30), radians(50)});
  rig.run(10s);  // its motors are off, where they go off
  const double there = rig.plant->pan();
  rig.plant->unplug();
  rig.run(1s);
  const std::string fault = rig.head.fault();
  ck_assert_msg(fault.find("does not") != std::string::npos, "'%s'", fault.c_str());
  rig.run(5s);
  assert_text(rig.head.fault(), fault.c_str());
  rig.plant->plug();
  rig.run(3s);
  assert_text(rig.head.fault(), "");
  ck_assert_double_eq(rig.plant->pan(), there);  // it stands until the next command
  rig.move({Kind::position, radians(-20), radians(50)});
  rig.run(5s);
  ck_assert_double_eq_tol(rig.plant->pan(), -20, rig.plant->precision());
}
END_TEST

START_TEST(an_emergency_stop_ends_what_moves_it) {
  Rig rig(_i);
  FakeLines contact;
  contact.inputs = {false};
  const auto plant = make_plant(_i);
  EmergencyStop guarded(plant->device(), std::make_unique<FakePort>(contact), "26");
  assert_text(guarded.open(setup(), 0s), "");
  Time now{};
  const auto run = [&](Time length) {
    for (const Time end = now + length; now < end;) {
      const Time next = guarded.tick(now);
      plant->elapse(now);
      guarded.take_pose(now);
      now = std::min(end, std::max(next, now + 1us));
    }
    plant->elapse(now);
  };
  guarded.move({Kind::velocity, radians(50), 0}, {}, now);
  run(1s);
  ck_assert_double_gt(plant->pan(), 20);
  contact.inputs[0] = true;
  run(50ms);
  ck_assert(guarded.emergency());
  run(100ms);
  ck_assert(!plant->powered());
  const double there = plant->pan();
  guarded.move({Kind::velocity, radians(50), 0}, {}, now);
  Limits narrow = setup().limits;  // the head is beyond them, and still neither these nor a stop move it
  narrow.pan.to = radians(5);
  guarded.limit(narrow, now);
  guarded.stop(now);
  run(1s);
  ck_assert(!plant->powered());
  contact.inputs[0] = false;
  run(1s);
  ck_assert(!guarded.emergency());
  ck_assert_double_eq(plant->pan(), there);
}
END_TEST

int main() {
  Suite* suite = suite_create("device_contract");
  TCase* cases = tcase_create("each driver");
  for (const TTest* test :
       {an_open_head_stands_and_a_move_arrives_within_its_precision, a_speed_is_kept_and_ends_at_the_limit,
        no_command_leads_beyond_a_limit, other_limits_hold_at_once_and_a_head_beyond_them_returns,
        a_stop_ends_all_motion_within_half_a_second_and_may_be_repeated, numbers_that_are_none_move_nothing,
        feedback_is_where_the_head_is,
        a_head_that_vanishes_at_rest_is_reported_within_a_second_and_used_again,
        an_emergency_stop_ends_what_moves_it})
    tcase_add_loop_test(cases, test, 0, kPlants);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
