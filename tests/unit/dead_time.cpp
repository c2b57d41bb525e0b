// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that is later or earlier than it was said to be: the picture turns with what was commanded that much before.
#include "control/following/dead_time.h"

#include <check.h>

#include <cmath>
#include <functional>
#include <random>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::control;
using namespace std::chrono_literals;
using cerberus::motion::Pose;
using cerberus::motion::PoseHistory;
using cerberus::motion::seconds;
using cerberus::motion::Time;
using cerberus::sensing::radians;

namespace {

using Angle = std::function<double(double)>;  // degrees at a time in seconds

// To and fro as a head goes that follows a walker, with turns of uneven length.
double walker(double t) {
  return 25 * std::sin(.9 * t) + 6 * std::sin(2.3 * t);
}
double nothing(double) {
  return 0;
}

struct Scene {
  Angle head = walker, base = nothing;
  double late = .2, noise = .03;  // seconds, degrees a frame
  double scale = 1;               // of what the head makes of its commands
  double step = .04;              // seconds between frames
  Time told = 100ms;

  // What was learnt after `length` seconds.
  double learnt(double length, unsigned seed = 1) const {
    DeadTime learner;
    PoseHistory reckoned;
    std::mt19937 random(seed);
    std::normal_distribution<double> gauss(0, noise);
    const auto time = [](double t) { return Time(1h) + Time(static_cast<Time::rep>(std::llround(t * 1e9))); };
    const auto look = [&](double t) { return scale * head(t - late) + base(t); };
    double recorded = 0;
    for (double t = step; t < length; t += step) {
      for (; recorded <= t + seconds(told); recorded += .02) {
        Pose pose;
        pose.from = time(recorded);
        pose.pan.position = radians(head(recorded));
        pose.pan.speed = radians(head(recorded + .01) - head(recorded)) / .01;
        reckoned.add(pose);
      }
      learner.add(time(t - step), time(t), radians(look(t) - look(t - step) + gauss(random)), reckoned, told);
    }
    return seconds(learner.late());
  }
};

constexpr double kStep = .02;  // DeadTime's

}  // namespace

START_TEST(a_head_that_is_late_or_early_is_found) {
  for (const double late : {-.08, 0., .06, .2, .5, .9}) {
    Scene scene;
    scene.late = late;
    ck_assert_double_eq_tol(scene.learnt(20), late, 1.5 * kStep);
  }
}
END_TEST

START_TEST(neither_a_wrong_speed_table_nor_rare_pictures_matter) {
  for (const double scale : {.7, 1.3})
    for (const double step : {.04, .1}) {
      Scene scene;
      scene.scale = scale;
      scene.step = step;
      ck_assert_double_eq_tol(scene.learnt(20), scene.late, 1.5 * kStep);
    }
}
END_TEST

START_TEST(a_head_that_rests_or_does_not_obey_teaches_nothing) {
  Scene rests;
  rests.head = nothing;
  ck_assert_double_eq(rests.learnt(20), 0);
  Scene trembles;  // too little to learn from
  trembles.head = [](double t) { return .3 * std::sin(t); };
  ck_assert_double_eq(trembles.learnt(20), 0);
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Scene slips;
    slips.scale = 0;
    slips.noise = .2;
    ck_assert_double_lt(std::abs(slips.learnt(20, seed)), kStep);
  }
}
END_TEST

// What a base adds lowers the correlation: either it is found all the same, or nothing is learnt.
START_TEST(a_base_that_turns_as_well_teaches_nothing_wrong) {
  Scene patrol;
  patrol.base = [](double t) { return 45 * std::sin(.6 * t + 1); };
  const double learnt = patrol.learnt(30);
  ck_assert(std::abs(learnt - patrol.late) < 2 * kStep || std::abs(learnt) < 2 * kStep);
}
END_TEST

// Poses are shifted by what is learnt: they must not jump.
START_TEST(it_is_approached_slowly) {
  Scene scene;
  scene.late = 1;
  double before = 0;
  for (double t = .5; t < 8; t += .5) {
    const double learnt = scene.learnt(t);
    ck_assert_double_le(learnt - before, .5 * .4);
    before = learnt;
  }
  ck_assert_double_gt(before, .8);
}
END_TEST

START_TEST(what_happens_no_earlier_than_the_command_is_never_assumed) {
  Scene scene;
  scene.told = 40ms;
  scene.late = -.2;  // it would have to move 160 ms before its command
  ck_assert_double_ge(scene.learnt(20), -.04);
}
END_TEST

START_TEST(absurd_frames_are_left_out_and_nothing_is_allocated) {
  DeadTime learner;
  PoseHistory reckoned;
  const std::size_t before = cerberus::tests::allocations();
  learner.add(1s, 1s, 1, reckoned, 100ms);
  learner.add(2s, 1s, 1, reckoned, 100ms);
  learner.add(1s, 3s, 1, reckoned, 100ms);
  for (int k = 0; k < 100; ++k) learner.add(k * 40ms, (k + 1) * 40ms, std::nan(""), reckoned, 100ms);
  ck_assert_int_eq(learner.late().count(), 0);
  ck_assert_uint_eq(cerberus::tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "dead_time",
      {a_head_that_is_late_or_early_is_found, neither_a_wrong_speed_table_nor_rare_pictures_matter,
       a_head_that_rests_or_does_not_obey_teaches_nothing, a_base_that_turns_as_well_teaches_nothing_wrong,
       it_is_approached_slowly, what_happens_no_earlier_than_the_command_is_never_assumed,
       absurd_frames_are_left_out_and_nothing_is_allocated});
}
