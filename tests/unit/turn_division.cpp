// SPDX-License-Identifier: LGPL-2.1-or-later
// Whose turn the picture shows: frames every 40 ms, degrees.
#include "control/turn_division.h"

#include <cmath>
#include <functional>

#include "control/pose_correction.h"
#include "support/suite.h"

using namespace cerberus::control;
using namespace std::chrono_literals;
using cerberus::motion::Pose;
using cerberus::motion::Time;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

constexpr double kStep = .04;

// A head by its driver's reckoning, what it really does, and a base below it: degrees a second at a time in seconds.
struct Scene {
  std::function<double(double)> reckoned = [](double) { return 0; }, real = reckoned, base = reckoned;
  bool known = false;  // something measures the base

  PoseCorrection correction;
  double head = 0, pose = 0, worst = 0;  // degrees

  Scene& run(double seconds) {
    correction.reset({}, 100ms);
    double at = 0;
    for (int k = 0; k * kStep < seconds; ++k) {
      const double t = k * kStep;
      Pose driver;
      driver.from = Time(1h) + k * 40ms;
      driver.pan.position = radians(at);
      driver.pan.speed = radians(reckoned(t));
      correction.add(driver);
      const double seen = k == 0 ? 0 : (real(t - kStep) + (known ? 0 : base(t - kStep))) * kStep;
      correction.on_frame(driver.from, driver, Turn{radians(seen), 0}, {}, known);
      pose = degrees(correction.position()->pan);
      worst = std::max(worst, std::abs(pose - head));
      head += real(t) * kStep;
      at += reckoned(t) * kStep;
    }
    return *this;
  }
};

std::function<double(double)> between(double from, double to, double speed) {
  return [=](double t) { return t >= from && t < to ? speed : 0; };
}

}  // namespace

START_TEST(a_head_that_got_no_command_did_not_turn_whatever_the_base_does) {
  for (const double speed : {45.0, -45.0, 4.0, 200.0}) {
    Scene scene;
    scene.base = between(1, 3, speed);
    scene.run(5);
    ck_assert_double_eq_tol(scene.worst, 0, 1e-9);
    ck_assert(!scene.correction.ambiguous());
    ck_assert(!scene.correction.lost());
  }
}
END_TEST

// The head is sent 8 degrees on in the middle of a base's turn by 90.
START_TEST(a_head_that_moves_while_the_base_turns_is_where_its_commands_lead) {
  Scene scene;
  scene.base = between(1, 3, 45);
  scene.reckoned = scene.real = between(1.4, 2.2, 10);
  scene.run(5);
  ck_assert_double_eq_tol(scene.pose, 8, .5);
  ck_assert_double_le(scene.worst, 1);
  ck_assert(scene.correction.ambiguous());
}
END_TEST

// It holds its target while the base turns below it: the picture stands.
START_TEST(a_head_that_turns_against_the_base_is_where_its_commands_lead) {
  Scene scene;
  scene.base = between(1, 3, 45);
  scene.reckoned = scene.real = between(1.2, 3, -45);
  scene.run(5);
  ck_assert_double_eq_tol(scene.pose, -81, 1);
  ck_assert_double_le(scene.worst, 3);
}
END_TEST

// Of the difference between the commanded and the seen turn, .4 degrees a frame, PoseEstimate takes 9 % from the commands:
// their deviation is .15 x .8 = .12 degrees, the picture's .03 + .02 x .4 = .038; 1.8 degrees in 2 s.
START_TEST(a_base_that_stands_leaves_the_picture_to_the_head) {
  for (const double share : {.5, 1.5}) {  // of what its speeds are said to be
    Scene scene;
    scene.reckoned = [](double t) { return t < 1 || t > 9 ? 0 : std::fmod(t, 4) < 2 ? 20 : -20; };
    scene.real = [&](double t) { return share * scene.reckoned(t); };
    scene.run(10);
    ck_assert_double_le(scene.worst, 2);
    ck_assert(!scene.correction.ambiguous());
  }
}
END_TEST

START_TEST(after_the_base_has_stood_the_picture_is_the_heads_again) {
  Scene scene;
  scene.base = between(1, 3, 45);
  scene.reckoned = between(5, 9, 20);
  scene.real = between(5, 9, 10);  // half of what its speed is said to be
  scene.run(11);
  ck_assert_double_eq_tol(scene.pose, 43.6, .5);  // 9 % of 40 degrees too far, as above
}
END_TEST

// A base that turns too slowly to be seen in a frame: below 5 degrees a second and 1.5 of the head's speed. The head looks
// to and fro, and its pose takes the base's turn.
START_TEST(a_slow_base_below_a_head_that_moves_is_ambiguous) {
  for (const double base : {2.0, -4.0, 8.0})
    for (const double speed : {5.0, 20.0}) {
      Scene scene;
      scene.base = [=](double t) { return t < 1 ? 0 : base; };
      scene.reckoned = scene.real = [=](double t) {
        return t < 1 ? 0 : std::fmod(t, 4) < 2 ? speed : -speed;
      };
      const double most = 5 + .5 * 2 * speed + .75 * speed;  // D may be so large
      scene.run(1 + 2 * most / std::abs(base));
      ck_assert(scene.correction.ambiguous());
    }
}
END_TEST

// The head holds its target while the base turns slowly: the picture stands.
START_TEST(a_slow_base_that_the_head_turns_against_is_ambiguous) {
  Scene scene;
  scene.base = between(1, 9, 5);
  scene.reckoned = scene.real = between(1, 9, -5);
  scene.run(9);
  ck_assert(scene.correction.ambiguous());
}
END_TEST

// Wrong speeds, a camera that is late by .3 s, and a picture's noise of a third of a pixel of 320 are the head's,
// which turns to and fro and rests for a second between.
START_TEST(a_head_that_errs_on_a_base_that_stands_is_not_ambiguous) {
  for (const double speed : {3.0, 20.0, 90.0})
    for (const double share : {.55, 1.0, 1.45})
      for (const double late : {0.0, .3})
        for (const double leg : {.6, 2.0, 20.0}) {
          Scene scene;
          scene.reckoned = [=](double t) {
            const double phase = std::fmod(t, 2 * leg + 2);
            if (t < 1 || t > 61 || std::fmod(phase, leg + 1) >= leg) return 0.0;
            return phase < leg ? speed : -speed;
          };
          scene.real = [&scene, share, late](double t) { return share * scene.reckoned(t - late); };
          scene.base = [k = 0](double) mutable { return (k++ % 5 - 2) * .03 / kStep; };
          scene.run(65);
          ck_assert_msg(!scene.correction.ambiguous(), "%g at %g, %g s late, %g s", share, speed, late, leg);
        }
}
END_TEST

// With a gyro the turn that is given is the head's: it was moved by hand, as nothing else explains it.
START_TEST(a_measured_base_leaves_the_picture_to_the_head) {
  Scene scene;
  scene.known = true;
  scene.base = between(1, 3, 45);
  scene.real = between(1, 2, 30);
  scene.run(5);
  ck_assert_double_eq_tol(scene.pose, 30, .5);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "turn_division",
      {a_head_that_got_no_command_did_not_turn_whatever_the_base_does,
       a_head_that_moves_while_the_base_turns_is_where_its_commands_lead,
       a_head_that_turns_against_the_base_is_where_its_commands_lead,
       a_base_that_stands_leaves_the_picture_to_the_head,
       after_the_base_has_stood_the_picture_is_the_heads_again,
       a_slow_base_below_a_head_that_moves_is_ambiguous, a_slow_base_that_the_head_turns_against_is_ambiguous,
       a_head_that_errs_on_a_base_that_stands_is_not_ambiguous,
       a_measured_base_leaves_the_picture_to_the_head});
}
