// SPDX-License-Identifier: LGPL-2.1-or-later
// Heads that execute their commands and heads that do not, as the picture shows it. Degrees here.
#include "control/slip.h"

#include <check.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <system_error>
#include <vector>

#include "support/suite.h"

using namespace cerberus::control;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

using Speed = std::function<double(double)>;  // degrees a second at a time in seconds

double turned(const Speed& speed, double from, double to) {
  constexpr int kSteps = 20;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += speed(from + (i + 0.5) * (to - from) / kSteps);
  return sum * (to - from) / kSteps;
}

// To the right for `seconds`, and back, for ever; `rise` seconds from one speed to the other.
Speed sweep(double speed, double seconds, double rise = 0.1) {
  return [=](double t) {
    if (t < 1) return 0.0;
    const double in = std::fmod(t - 1, 2 * seconds);
    const double there = std::clamp((in < seconds ? in : 2 * seconds - in) / rise, -1.0, 1.0);
    return t < 1 + rise ? speed * (t - 1) / rise : in < seconds ? speed * there : -speed * there;
  };
}

// By `angle` degrees to the right, a rest, and back, for ever.
Speed steps(double angle, double speed, double acceleration, double rest) {
  const double rise = speed / acceleration, takes = angle / speed + rise;
  return [=](double t) {
    if (t < 1) return 0.0;
    const double in = std::fmod(t - 1, 2 * (takes + rest));
    const bool back = in >= takes + rest;
    const double since = back ? in - takes - rest : in;
    return (back ? -speed : speed) * std::clamp(std::min(since, takes - since) / rise, 0.0, 1.0);
  };
}

// Degrees that it turned from the begin to `seconds`.
double travelled(const Speed& speed, double seconds) {
  constexpr double kStep = 0.005;
  double sum = 0;
  for (double t = 0; t < seconds; t += kStep) sum += std::abs(speed(t)) * kStep;
  return sum;
}

double nothing(double) {
  return 0;
}

struct Sight {
  double gain = 1;       // share of the commanded turn that the head makes
  double late = 0;       // seconds
  Speed base = nothing;  // the robot's own turning
  double noise = 0.02;   // degrees a frame
  double frame = 1 / 30.0;
  std::function<bool(int)> seen = [](int) { return true; };
};

// What is found of `head` in so many seconds; `first`: when the first of it was.
std::vector<SlipFinding> findings(const Speed& head, const Sight& sight, double seconds, unsigned seed = 1,
                                  SlipWatch* watch = nullptr, double* first = nullptr) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;  // of deviation 1: 0 is not allowed there
  SlipWatch own;
  std::vector<SlipFinding> all;
  for (int k = 1; k * sight.frame < seconds; ++k) {
    const double to = k * sight.frame, from = to - sight.frame;
    double picture =
        sight.gain * turned(head, from - sight.late, to - sight.late) + turned(sight.base, from, to);
    if (picture != 0) picture += sight.noise * normal(random);  // a picture that stands is snapped to stand
    if (!sight.seen(k)) picture = kNan;
    const auto found =
        (watch ? *watch : own).add(sight.frame, radians(picture), radians(turned(head, from, to)));
    if (found && all.empty() && first) *first = to;
    if (found) all.push_back(*found);
  }
  return all;
}

void assert_finds(const std::vector<SlipFinding>& all, SlipFault fault, double gain, const char* what) {
  ck_assert_msg(all.size() == 1, "%s: %zu findings", what, all.size());
  ck_assert_msg(all[0].fault == fault, "%s: fault %d", what, static_cast<int>(all[0].fault));
  ck_assert_double_eq_tol(all[0].gain, gain, 0.1 * std::max(1.0, std::abs(gain)));
  ck_assert_double_ge(degrees(all[0].travel), 20);
}

void assert_silent(const std::vector<SlipFinding>& all, const char* what, unsigned seed = 0) {
  ck_assert_msg(all.empty(), "%s %u: fault %d, gain %g, travel %g", what, seed,
                all.empty() ? 0 : static_cast<int>(all[0].fault), all.empty() ? 0 : all[0].gain,
                all.empty() ? 0 : degrees(all[0].travel));
}

// Of the robots and people that turn below a head that executes its commands. 33 are a day of them.
unsigned seeds() {
  const char* asked = std::getenv("CERBERUS_SLIP_SEEDS");
  if (!asked) return 20;
  unsigned number = 0;
  const char* const end = asked + std::strlen(asked);
  const auto [stop, error] = std::from_chars(asked, end, number);
  ck_assert_msg(stop == end && error == std::errc() && number > 0,
                "CERBERUS_SLIP_SEEDS=%s: how many is that? A number from 1 on", asked);
  return number;
}

// A robot that turns now and then, at speeds and accelerations (degrees a second squared) of its own.
Speed robot(unsigned seed, double acceleration) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> speed(-60, 60), pause(0.5, 3);
  std::vector<std::pair<double, double>> corners{{0, 0}};  // time, speed
  while (corners.back().first < 100) {
    const auto [t, was] = corners.back();
    const double hold = t + pause(random), next = random() % 2 ? speed(random) : 0;
    corners.emplace_back(hold, was);
    corners.emplace_back(hold + std::max(0.02, std::abs(next - was) / acceleration), next);
  }
  return [corners](double t) {
    std::size_t i = 1;
    while (corners[i].first < t) ++i;
    const auto &a = corners[i - 1], &b = corners[i];
    return a.second + (b.second - a.second) * (t - a.first) / std::max(1e-9, b.first - a.first);
  };
}

// The speeds of a head that follows what moves with `target` (a bearing's speed as the robot sees it): proportionally,
// over a delay, within its acceleration, with a dead band.
Speed follower(const Speed& target, double delay, double gain = 4, double acceleration = 600) {
  constexpr double kStep = 0.005;
  std::vector<double> speeds;
  std::vector<double> errors;
  double error = 0, speed = 0;
  bool moving = false;
  for (double t = 0; t < 100; t += kStep) {
    error += (target(t) - speed) * kStep;
    errors.push_back(error);
    const auto ago = static_cast<std::size_t>(delay / kStep);
    const double seen = errors.size() > ago ? errors[errors.size() - 1 - ago] : 0;
    moving = std::abs(seen) > (moving ? 0.7 : 3);
    const double wanted = moving ? std::clamp(gain * seen, -90.0, 90.0) : 0;
    speed += std::clamp(wanted - speed, -acceleration * kStep, acceleration * kStep);
    speeds.push_back(speed);
  }
  return [speeds](double t) {
    return t < 0 ? 0 : speeds[std::min(speeds.size() - 1, static_cast<std::size_t>(t / kStep))];
  };
}

}  // namespace

START_TEST(a_head_that_follows_is_silent) {
  for (const double late : {0.0, 0.03, 0.08})
    for (const double speed : {20.0, 40.0, 90.0})
      assert_silent(findings(sweep(speed, 1.3), {.late = late}, 60), "sweep");
  for (const double gain : {0.85, 1.2})  // a lens that is not known better
    assert_silent(findings(sweep(40, 1.3), {.gain = gain, .late = 0.03}, 60), "nearly");
}
END_TEST

START_TEST(a_head_that_slips_is_found_once) {
  assert_finds(findings(sweep(40, 1.3), {.gain = 0, .noise = 0}, 60), SlipFault::slips, 0, "slips");
  assert_finds(findings(sweep(40, 1.3), {.gain = 0.05}, 60), SlipFault::slips, 0.05, "slips nearly");
  assert_finds(findings(sweep(40, 1.3), {.gain = 1e-9, .noise = 0.001}, 60), SlipFault::slips, 0, "trembles");
}
END_TEST

START_TEST(a_head_that_turns_the_wrong_way_is_found_once) {
  assert_finds(findings(sweep(40, 1.3), {.gain = -1}, 60), SlipFault::reversed, -1, "reversed");
  assert_finds(findings(sweep(25, 0.9), {.gain = -0.6, .late = 0.05}, 60), SlipFault::reversed, -0.6, "late");
}
END_TEST

START_TEST(a_head_that_turns_by_another_angle_is_found_once) {
  for (const double gain : {0.5, 0.6, 1.7, 2.0})
    for (const double late : {0.0, 0.04})
      assert_finds(findings(sweep(40, 1.3), {.gain = gain, .late = late}, 60), SlipFault::scale, gain,
                   "scale");
}
END_TEST

// Every fault, by a picture as noisy as the real ones (0.03 degrees a frame; a head up to a tenth of a second late). In
// the first 20 degrees nothing may be reported; a second change of
// speed there must be, for a wrong scale a third, and then it is.
START_TEST(a_fault_is_found_soon_after_twenty_degrees) {
  const struct {
    const char* what;
    Speed head;
    double most, most_of_scale;  // degrees of travel
  } moves[] = {
      {"steps of 5 degrees", steps(5, 30, 200, 1), 50, 50},
      {"steps of 8 degrees", steps(8, 20, 200, 0.6), 33, 33},
      {"steps of 10 degrees", steps(10, 40, 400, 1), 41, 41},
      {"steps of 20 degrees", steps(20, 60, 300, 0.7), 41, 61},
      // Its second turn is after 22 degrees, the third after 45, and each is seen half a second later.
      {"short sweeps", sweep(25, 0.9), 43, 66},
      {"long sweeps", sweep(40, 1.3), 80, 131},
      {"a sine", [](double t) { return t < 1 ? 0 : 30 * std::sin(M_PI * (t - 1)); }, 41, 60},
  };
  for (const auto& move : moves)
    for (const auto& [gain, fault] : {std::pair{0.0, SlipFault::slips},
                                      {-1.0, SlipFault::reversed},
                                      {0.5, SlipFault::scale},
                                      {0.6, SlipFault::scale},
                                      {1.6, SlipFault::scale},
                                      {2.0, SlipFault::scale}})
      for (const double late : {0.0, 0.033, 0.045, 0.086})
        for (unsigned seed = 1; seed <= 4; ++seed) {
          double found = 0;
          const Sight sight{.gain = gain, .late = late, .noise = 0.03};
          assert_finds(findings(move.head, sight, 20, seed, nullptr, &found), fault, gain, move.what);
          const double most = fault == SlipFault::scale ? move.most_of_scale : move.most;
          ck_assert_msg(travelled(move.head, found) <= most, "%s, gain %g, late %g: %g degrees", move.what,
                        gain, late, travelled(move.head, found));
        }
}
END_TEST

START_TEST(slow_changes_will_do) {
  const Speed sine = [](double t) { return 30 * std::sin(M_PI * t); };  // at most 94 degrees a second squared
  assert_silent(findings(sine, {.late = 0.03}, 60), "follows");
  assert_finds(findings(sine, {.gain = 0, .noise = 0}, 60), SlipFault::slips, 0, "slips");
  assert_finds(findings(sine, {.gain = -1}, 60), SlipFault::reversed, -1, "reversed");
  assert_finds(findings(sine, {.gain = 0.5}, 60), SlipFault::scale, 0.5, "half");
}
END_TEST

START_TEST(at_any_frame_rate_the_same_is_found) {
  for (const double rate : {5.0, 10.0, 15.0, 25.0, 60.0, 120.0}) {
    const double frame = 1 / rate;
    assert_silent(findings(sweep(40, 1.3), {.late = 0.02, .frame = frame}, 60), "follows");
    assert_finds(findings(sweep(40, 1.3), {.gain = 0, .noise = 0, .frame = frame}, 60), SlipFault::slips, 0,
                 "slips");
    assert_finds(findings(sweep(40, 1.3), {.gain = -1, .frame = frame}, 60), SlipFault::reversed, -1,
                 "reversed");
    assert_finds(findings(sweep(40, 1.3), {.gain = 0.5, .frame = frame}, 60), SlipFault::scale, 0.5, "half");
  }
}
END_TEST

START_TEST(twenty_degrees_of_travel_come_first) {
  // Twitches of 4.4 degrees, one a second: the fifth is beyond.
  const Speed twitch = [](double t) {
    const double in = std::fmod(t, 2.0);
    return t < 1 ? 0 : in < 0.22 ? 20.0 : in >= 1 && in < 1.22 ? -20.0 : 0.0;
  };
  assert_silent(findings(twitch, {.gain = -1, .noise = 0}, 4.9), "four twitches");
  assert_finds(findings(twitch, {.gain = -1, .noise = 0}, 7), SlipFault::reversed, -1, "six twitches");
}
END_TEST

START_TEST(a_steady_head_is_no_evidence) {
  // One start in a hundred seconds; a robot may do anything meanwhile.
  const Speed once = [](double t) { return t < 1 ? 0.0 : 40.0; };
  assert_silent(findings(once, {.gain = 0, .noise = 0}, 90), "steady");
}
END_TEST

START_TEST(a_robot_that_turns_is_no_fault_of_its_head) {
  for (unsigned seed = 1; seed <= seeds(); ++seed)
    for (const double acceleration : {30.0, 100.0, 400.0}) {
      const Speed base = robot(seed, acceleration);
      assert_silent(findings(nothing, {.base = base}, 90, seed), "head at rest", seed);
      assert_silent(findings(sweep(40, 1.3), {.late = 0.03, .base = base}, 90, seed), "head sweeps", seed);
      assert_silent(findings(steps(10, 40, 400, 1), {.late = 0.06, .base = base}, 90, seed), "steps", seed);
      assert_silent(findings(steps(5, 30, 200, 1), {.base = base}, 90, seed), "short steps", seed);
    }
}
END_TEST

// The head turns against the robot and the picture stands: the one thing that looks like a head that slips.
START_TEST(a_head_that_holds_a_target_on_a_turning_robot_does_not_slip) {
  for (unsigned seed = 1; seed <= seeds(); ++seed)
    for (const double acceleration : {30.0, 60.0, 120.0, 400.0})
      for (const double delay : {0.06, 0.12}) {
        const Speed base = robot(seed, acceleration);
        const Speed head = follower([&](double t) { return -base(t); }, delay);
        for (const double late : {0.0, 0.03})
          assert_silent(findings(head, {.late = late, .base = base}, 90, seed), "holds", seed);
      }
}
END_TEST

// The camera's motion is the person's then: what the head does without what the person does.
START_TEST(a_person_who_fills_the_picture_is_no_fault_of_the_head) {
  for (unsigned seed = 1; seed <= seeds(); ++seed) {
    const Speed person = robot(100 + seed, 90);
    const Speed head = follower(person, 0.1);
    assert_silent(findings(head, {.base = [&](double t) { return -person(t); }}, 90, seed), "person", seed);
  }
}
END_TEST

// A wrong gear is always wrong by the same.
START_TEST(a_gain_that_is_another_one_each_time_is_no_wrong_scale) {
  const Speed head = steps(10, 40, 400, 1);  // a step every 1.35 seconds
  const auto turning_by = [&](double one, double other) {
    return [=](double t) { return ((t < 1 || std::fmod(t - 1, 2.7) < 1.35 ? one : other) - 1) * head(t); };
  };
  assert_finds(findings(head, {.base = turning_by(0.5, 0.5)}, 60), SlipFault::scale, 0.5, "always");
  assert_silent(findings(head, {.base = turning_by(0.4, 0.65)}, 60), "another one");
  assert_silent(findings(head, {.base = turning_by(1.6, 0.5)}, 60), "more and less");
}
END_TEST

START_TEST(a_robot_that_turns_hides_no_fault) {
  int found = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto all = findings(sweep(40, 1.3), {.gain = -1, .base = robot(seed, 60)}, 60, seed);
    ck_assert(all.size() <= 1);
    found += !all.empty() && all[0].fault == SlipFault::reversed;
  }
  ck_assert_int_eq(found, 20);
}
END_TEST

START_TEST(a_picture_without_a_measurement_does_not_count) {
  assert_silent(findings(sweep(40, 1.3), {.gain = 0, .noise = 0, .seen = [](int) { return false; }}, 60),
                "blank");
  // Too few of them say something.
  assert_silent(findings(sweep(40, 1.3), {.gain = -1, .seen = [](int k) { return k % 4 == 0; }}, 60), "few");
  // One frame of three is not sure.
  const auto some = [](int k) { return k % 3 != 0; };
  assert_silent(findings(sweep(40, 1.3), {.seen = some}, 60), "some");
  assert_finds(findings(sweep(40, 1.3), {.gain = 0, .noise = 0, .seen = some}, 60), SlipFault::slips, 0,
               "some");
}
END_TEST

START_TEST(a_fault_is_found_anew_after_the_head_has_followed) {
  SlipWatch watch;
  const Sight slips{.gain = 0, .noise = 0};
  ck_assert_uint_eq(findings(sweep(40, 1.3), slips, 60, 1, &watch).size(), 1);
  ck_assert_uint_eq(findings(sweep(40, 1.3), slips, 60, 1, &watch).size(), 0);
  ck_assert(watch.fault() == SlipFault::slips);
  ck_assert_uint_eq(findings(sweep(40, 1.3), {}, 60, 1, &watch).size(), 0);
  ck_assert(watch.fault() == SlipFault::none);
  assert_finds(findings(sweep(40, 1.3), slips, 60, 1, &watch), SlipFault::slips, 0, "again");
  // Another fault is another finding.
  assert_finds(findings(sweep(40, 1.3), {.gain = -1}, 60, 1, &watch), SlipFault::reversed, -1, "another");
  watch.reset();
  ck_assert(watch.fault() == SlipFault::none);
}
END_TEST

START_TEST(numbers_that_are_none_do_no_harm) {
  SlipWatch watch;
  for (const double bad : {kNan, HUGE_VAL, -HUGE_VAL, 0.0, -1.0, 1e300})
    for (const double other : {kNan, HUGE_VAL, 0.1, 1e300})
      for (int i = 0; i < 20; ++i) {
        watch.add(bad, other, other);
        watch.add(0.04, bad, other);
        watch.add(0.04, other, bad);
      }
  watch.add(0.04, 0, 1e300);  // and without a reset
  assert_finds(findings(sweep(40, 1.3), {.gain = -1}, 60, 1, &watch), SlipFault::reversed, -1, "afterwards");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "slip", {a_head_that_follows_is_silent, a_head_that_slips_is_found_once,
               a_head_that_turns_the_wrong_way_is_found_once,
               a_head_that_turns_by_another_angle_is_found_once, a_fault_is_found_soon_after_twenty_degrees,
               slow_changes_will_do, at_any_frame_rate_the_same_is_found, twenty_degrees_of_travel_come_first,
               a_steady_head_is_no_evidence, a_robot_that_turns_is_no_fault_of_its_head,
               a_head_that_holds_a_target_on_a_turning_robot_does_not_slip,
               a_person_who_fills_the_picture_is_no_fault_of_the_head,
               a_gain_that_is_another_one_each_time_is_no_wrong_scale, a_robot_that_turns_hides_no_fault,
               a_picture_without_a_measurement_does_not_count,
               a_fault_is_found_anew_after_the_head_has_followed, numbers_that_are_none_do_no_harm});
}
