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
  return cerberus::tests::run_suite("turn_division",
                                    {a_head_that_got_no_command_did_not_turn_whatever_the_base_does,
                                     a_head_that_moves_while_the_base_turns_is_where_its_commands_lead,
                                     a_head_that_turns_against_the_base_is_where_its_commands_lead,
                                     a_base_that_stands_leaves_the_picture_to_the_head,
                                     after_the_base_has_stood_the_picture_is_the_heads_again,
                                     a_measured_base_leaves_the_picture_to_the_head});
}
