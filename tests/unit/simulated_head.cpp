// SPDX-License-Identifier: LGPL-2.1-or-later
// What only a simulated head does: latency, steps, play, noise. 1 a
// second and 2 a second squared: 0.5 s and 0.25 of way to full speed.
#include "drivers/simulated/simulated_head.h"

#include <check.h>

#include <cmath>
#include <random>
#include <string>

#include "../support/allocations.h"
#include "../support/suite.h"

using namespace cerberus::motion;
using namespace cerberus::drivers;
using namespace std::chrono_literals;
using Kind = AxisCommand::Kind;

namespace {

HeadSetup setup() {
  HeadSetup setup;
  setup.limits.pan = {-3, 3, 1, 2};
  setup.limits.tilt = {-1, 1, 1, 2};
  return setup;
}

struct Opened {
  SimulatedHead head;
  explicit Opened(const HeadSetup& with) {
    const std::string wrong = head.open(with);
    ck_assert_str_eq(wrong.c_str(), "");
  }
  void send(Time time, const AxisCommand& pan) {
    const std::string wrong = head.command({time, pan, {}});
    ck_assert_str_eq(wrong.c_str(), "");
  }
  Pose at(Time time) {
    Pose pose;
    head.state(time, pose);
    return pose;
  }
  double pan(Time time) { return at(time).pan.position; }
};

}  // namespace

START_TEST(an_impossible_setting_is_reported_with_its_name_and_value) {
  const auto refusal = [](auto change) {
    HeadSetup with = setup();
    change(with);
    return SimulatedHead().open(with);
  };
  const struct {
    std::string found;
    const char* expected;
  } cases[] = {{refusal([](HeadSetup& s) { s.step = cerberus::sensing::radians(-0.5); }),
                "step-size must be 0 or more, and is -0.5 degrees"},
               {refusal([](HeadSetup& s) { s.backlash = HUGE_VAL; }),
                "backlash must be 0 or more, and is inf degrees"},
               {refusal([](HeadSetup& s) { s.noise = NAN; }), "noise must be 0 or more, and is nan degrees"},
               {refusal([](HeadSetup& s) { s.latency = 5500ms; }), "latency must be 0 to 5 s, and is 5.5 s"},
               {refusal([](HeadSetup& s) { s.latency = -1s; }), "latency must be 0 to 5 s, and is -1 s"}};
  for (const auto& c : cases) ck_assert_str_eq(c.found.c_str(), c.expected);
}
END_TEST

START_TEST(a_command_counts_after_the_latency) {
  HeadSetup with = setup();
  with.latency = 100ms;
  Opened head(with);
  head.send(1s, {Kind::position, 2, 1});
  ck_assert_double_eq(head.pan(1100ms), 0);
  ck_assert_double_eq_tol(head.pan(1350ms), 0.0625, 1e-9);  // 2 x 0.25^2 / 2
  ck_assert_double_eq_tol(head.pan(1600ms), 0.25, 1e-9);
  ck_assert_double_eq_tol(head.pan(2100ms), 0.75, 1e-9);
  // What will hold until when is known before: rest, then the first piece.
  ck_assert_int_eq(head.at(1s).until.count(), Time(1100ms).count());
  ck_assert(!head.at(1s).settled);
  ck_assert_int_eq(head.at(1100ms).until.count(), Time(1600ms).count());
}
END_TEST

START_TEST(commands_on_their_way_are_not_lost) {
  HeadSetup with = setup();
  with.latency = 1s;
  Opened head(with);
  head.send(0s, {Kind::position, 2, 1});
  head.send(500ms, {});
  ck_assert_double_eq_tol(head.pan(1500ms), 0.25, 1e-9);  // the first one counts half a second
  ck_assert_double_eq_tol(head.pan(9s), 0.5, 1e-9);       // and braking takes 0.25
}
END_TEST

START_TEST(a_flood_of_commands_is_refused_not_forgotten) {
  HeadSetup with = setup();
  with.latency = 5s;
  Opened head(with);
  head.send(0s, {Kind::velocity, 0.1, 0});
  bool refused = false;
  for (int k = 0; k < 1000 && !refused; ++k)
    refused = !head.head.command({6s + k * 1ms, {Kind::position, k * 0.001, 1}, {}}).empty();
  ck_assert(refused);
  // Until the first of the flood has come, at 11 s, it executes the earlier command.
  ck_assert_double_eq_tol(head.pan(10s), 5 * 0.1 - 0.1 * 0.1 / (2 * 2), 1e-9);
  with.latency = 100ms;
  Opened quick(with);
  for (int k = 0; k < 1000; ++k) quick.send(k * 1ms, {Kind::position, k * 0.001, 1});
  ck_assert_double_eq_tol(quick.pan(60s), 0.999, 1e-9);
}
END_TEST

START_TEST(it_rests_on_a_step) {
  HeadSetup with = setup();
  with.step = 0.3;
  Opened head(with);
  head.send(0s, {Kind::position, 1, 1});
  ck_assert_double_eq_tol(head.pan(9s), 0.9, 1e-9);
  head.send(10s, {Kind::velocity, 1, 0});
  ck_assert_double_eq_tol(head.pan(60s), 3, 1e-9);
}
END_TEST

// 0.2 of play: the camera waits while the motor turns 0.1 from the middle, and 0.2 after each reversal.
START_TEST(the_camera_follows_the_motor_with_play) {
  HeadSetup with = setup();
  with.backlash = 0.2;
  Opened head(with);
  head.send(0s, {Kind::position, 1, 1});
  const double contact = std::sqrt(0.1);  // 2 t^2 / 2 = 0.1
  ck_assert_double_eq(head.pan(Time(static_cast<Time::rep>(contact * 0.99e9))), 0);
  ck_assert_int_le(std::abs(head.at(0s).until.count() - static_cast<Time::rep>(contact * 1e9)), 2);
  ck_assert_double_eq(head.at(0s).pan.speed, 0);
  ck_assert_double_eq_tol(head.pan(500ms), 0.25 - 0.1, 1e-9);
  ck_assert_double_eq_tol(head.at(600ms).pan.speed, 1, 1e-9);
  ck_assert_double_eq_tol(head.pan(5s), 0.9, 1e-9);
  head.send(5s, {Kind::position, 0, 1});
  ck_assert_double_eq_tol(head.pan(5400ms), 0.9, 1e-9);  // 0.16 of the play
  ck_assert_double_eq_tol(head.pan(9s), 0.1, 1e-9);
  // Back and forth within one plan: commanded to return while it moves.
  head.send(10s, {Kind::position, 2, 1});
  head.send(11s, {Kind::position, 0.5, 1});
  ck_assert_double_eq_tol(head.pan(60s), 0.6, 1e-9);
}
END_TEST

// The pieces that state() returns, put together, are the trajectory.
START_TEST(pieces_meet_and_make_the_whole_way) {
  HeadSetup with = setup();
  with.backlash = 0.05;
  with.latency = 60ms;
  Opened head(with);
  Time checked{};
  for (int k = 0; k < 100; ++k) {
    const Time now = k * 100ms;
    head.send(now, {Kind::position, k % 7 * 0.4 - 1, 1});
    while (checked < now) {
      const Pose piece = head.at(checked);
      const Time end = std::min(piece.until, now);
      for (int part = 0; part <= 4; ++part) {
        const Time t = checked + (end - checked) * part / 4;
        ck_assert_double_eq_tol(piece.at(t).pan.position, head.pan(t), 1e-7);
      }
      checked = end;
    }
  }
}
END_TEST

START_TEST(equal_seeds_give_equal_noise_and_others_other) {
  HeadSetup with = setup();
  with.noise = 0.01;
  with.seed = 1;
  Opened one(with), same(with);
  with.seed = 2;
  Opened other(with);
  double sum = 0, squares = 0;
  int equal = 0;
  constexpr int kCount = 4000;
  for (int k = 0; k < kCount; ++k) {
    const double value = one.pan(k * 1ms);
    ck_assert_double_eq(value, same.pan(k * 1ms));
    equal += value == other.pan(k * 1ms);
    sum += value;
    squares += value * value;
  }
  ck_assert_int_eq(equal, 0);
  ck_assert_double_eq_tol(sum / kCount, 0, 0.001);
  ck_assert_double_eq_tol(std::sqrt(squares / kCount), 0.01, 0.001);
  ck_assert(one.at(0s).measured);
}
END_TEST

START_TEST(numbers_that_are_none_do_not_make_a_head) {
  for (double HeadSetup::* number : {&HeadSetup::step, &HeadSetup::backlash, &HeadSetup::noise}) {
    HeadSetup with = setup();
    with.*number = -1;
    SimulatedHead head;
    ck_assert(!head.open(with).empty());
    with.*number = std::nan("");
    ck_assert(!head.open(with).empty());
  }
  HeadSetup with = setup();
  with.latency = 6s;
  SimulatedHead head;
  ck_assert(!head.open(with).empty());
}
END_TEST

// 0.5 s and 0.25 of way to full speed: at 1.1 s on the way at 0.75.
START_TEST(new_limits_count_after_the_latency) {
  HeadSetup with = setup();
  with.latency = 100ms;
  for (const bool later : {false, true}) {
    Opened head(with);
    head.send(0s, {Kind::position, 2.5, 5});
    const Limits slower{.pan = {-3, 3, 0.25, 1}, .tilt = {-1, 1, 1, 2}};
    ck_assert(head.head.limit(1s, slower).empty());
    if (later) head.send(1s, {Kind::position, 2.5, 5});  // the same again changes nothing
    ck_assert_double_eq_tol(head.at(1099ms).pan.speed, 1, 1e-9);
    // From 1 to 0.25 a second at 1 a second squared: 0.75 s; and then so.
    ck_assert_double_eq_tol(head.at(1400ms).pan.acceleration, -1, 1e-9);
    ck_assert_double_eq_tol(head.at(1850ms).pan.speed, 0.25, 1e-9);
    ck_assert_double_eq_tol(head.pan(1850ms), 0.75 + 0.625 * 0.75, 1e-9);
    ck_assert_double_eq_tol(head.at(3s).pan.speed, 0.25, 1e-9);
    ck_assert_double_eq_tol(head.pan(60s), 2.5, 1e-9);
  }
}
END_TEST

// A stop that is moved to just before a head that cannot brake in time: it brakes harder, and does not pass.
START_TEST(a_stop_that_is_too_near_to_brake_for_is_not_passed) {
  Opened head(setup());
  head.send(0s, {Kind::velocity, 1, 0});
  Limits narrow = setup().limits;
  narrow.pan.to = 0.76;  // braking takes 0.25
  ck_assert(head.head.limit(1s, narrow).empty());
  for (Time t = 1s; t < 2s; t += 1ms) ck_assert_double_le(head.pan(t), 0.76);
  ck_assert_double_eq_tol(head.pan(2s), 0.76, 1e-9);
}
END_TEST

// Whatever is asked for and whenever the stops are moved: no jump, and beyond a stop only inwards.
START_TEST(moved_stops_lead_no_head_further_out) {
  HeadSetup with = setup();
  with.latency = 60ms;
  with.noise = 1e-4;  // the feedback is not limited to a stop that the head is beyond
  Opened head(with);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(0, 1);
  AxisLimits past = with.limits.pan, now = past;
  double last = 0;
  int beyond = 0;
  for (int k = 0; k < 2000; ++k) {
    const Time time = k * 70ms;
    past = now;
    if (k % 3 == 0) {
      now = {-3 * number(random), 3 * number(random), 0.1 + 0.9 * number(random), 0.5 + 2 * number(random)};
      ck_assert(head.head.limit(time, {.pan = now, .tilt = now}).empty());
    } else {
      head.send(time, {static_cast<Kind>(k / 3 % 3), 8 * number(random) - 4, 2 * number(random)});
    }
    for (Time t = time; t < time + 70ms; t += 10ms) {
      const AxisLimits& limits = t < time + 60ms ? past : now;
      const double position = head.pan(t);
      constexpr double kNoise = 1e-3;                                 // 7 deviations between two
      ck_assert_double_le(std::abs(position - last), 0.01 + kNoise);  // 1 a second at most
      if (!limits.holds(position) && t != time + 60ms) {              // then `last` was within
        ck_assert_double_le(std::abs(position), std::abs(last) + kNoise);
        ++beyond;
      }
      last = position;
    }
  }
  ck_assert_int_ge(beyond, 100);  // or this test is void
}
END_TEST

// 60 and 15 degrees: the middle has sqrt(tan 30 tan 7.5) = .275699 for half its view, 15.4135 degrees to each side.
START_TEST(a_zoom_crosses_its_range_in_three_seconds_and_the_head_turns_meanwhile) {
  HeadSetup with = setup();
  with.latency = 100ms;
  const auto seen = [](const Pose& pose) { return cerberus::sensing::degrees(pose.field_of_view); };
  ck_assert_double_eq(seen(Opened(with).at(0s)), 0);  // without a table it has none
  ck_assert(with.zoom_table.parse("0 60; 1 15").empty());
  Opened head(with);
  ck_assert_double_eq_tol(seen(head.at(0s)), 60, 1e-9);
  const AxisCommand turn{Kind::velocity, .5, 0};
  HeadCommand zoom{1s, turn, {}};
  zoom.zoom = 1;
  ck_assert(head.head.command(zoom).empty());
  ck_assert_double_eq_tol(seen(head.at(1100ms)), 60, 1e-9);
  ck_assert_double_eq_tol(seen(head.at(2600ms)), 30.8270, 1e-3);
  ck_assert(head.at(2600ms).until <= 2640ms);  // a pose of a moving zoom does not hold for long
  ck_assert_double_eq_tol(seen(head.at(4200ms)), 15, 1e-9);
  head.send(2500ms, turn);  // the same again: the zoom goes on
  ck_assert_double_eq_tol(head.at(3s).pan.speed, .5, 1e-9);
  ck_assert_double_eq_tol(seen(head.at(4200ms)), 15, 1e-9);
  head.send(3s, {});
  ck_assert_double_eq_tol(seen(head.at(4200ms)), 15, 1e-9);
}
END_TEST

START_TEST(steady_state_allocates_nothing) {
  Opened head(setup());
  const std::size_t before = cerberus::tests::allocations();
  for (int k = 0; k < 1000; ++k) {
    head.head.command({k * 1ms, {Kind::position, k * 0.001, 1}, {}});
    head.pan(k * 1ms);
  }
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "simulated_head",
      {an_impossible_setting_is_reported_with_its_name_and_value, a_command_counts_after_the_latency,
       commands_on_their_way_are_not_lost, a_flood_of_commands_is_refused_not_forgotten, it_rests_on_a_step,
       new_limits_count_after_the_latency, a_stop_that_is_too_near_to_brake_for_is_not_passed,
       moved_stops_lead_no_head_further_out, the_camera_follows_the_motor_with_play,
       pieces_meet_and_make_the_whole_way, equal_seeds_give_equal_noise_and_others_other,
       numbers_that_are_none_do_not_make_a_head,
       a_zoom_crosses_its_range_in_three_seconds_and_the_head_turns_meanwhile,
       steady_state_allocates_nothing});
}
