// SPDX-License-Identifier: LGPL-2.1-or-later
// How simulated people walk, and the size of their bodies.
#include "sim/house/figure.h"
#include "sim/house/walker.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>

#include "support/suite.h"

using namespace cerberus::sim;
using namespace std::chrono_literals;
using I = Instruction;

START_TEST(a_walker_keeps_its_speed_and_acceleration_between_its_places) {
  Walker walker(0, 0, 0, {{I::go, 6, 0, 1.4, 0, true}, {I::go, 6, 4, 1.4, 0, true}, {I::go, 0, 0, 4}},
                {1.75, 3});
  double fastest = 0, hardest = 0, vx = 0, vy = 0, x = 0, y = 0, furthest = 0;
  for (cerberus::motion::Time t = 2ms; t < 20s; t += 2ms) {
    walker.elapse(t);
    const Stance& now = walker.stance();
    const double ax = (now.x - x) / .002, ay = (now.y - y) / .002;
    hardest = std::max(hardest, std::hypot(ax - vx, ay - vy) / .002);
    fastest = std::max(fastest, std::hypot(ax, ay));
    ck_assert_double_eq_tol(std::hypot(ax, ay), now.speed, 1e-6);
    if (t < 6s) furthest = std::max(furthest, now.x);
    vx = ax, vy = ay, x = now.x, y = now.y;
  }
  ck_assert_double_eq_tol(hardest, 3, .01);
  ck_assert_double_gt(fastest, 2.5);
  ck_assert_double_le(fastest, 4 + 1e-6);
  ck_assert_double_eq_tol(furthest, 6, .1);
}
END_TEST

START_TEST(a_walker_stands_and_gestures_as_told) {
  Walker walker(1, 1, 0, {{I::go, 2, 1, 1, 0, true}, {I::stand, 0, 0, 0, 3}, {I::gesture, 0, 0, 0, 9}}, {});
  walker.elapse(4s);
  ck_assert_double_eq_tol(walker.stance().x, 2, .1);
  ck_assert_double_eq_tol(walker.stance().speed, 0, 1e-9);
  ck_assert_double_eq_tol(walker.stance().heading, 0, .02);
  ck_assert_double_eq_tol(walker.stance().gesture, 0, 1e-9);
  walker.elapse(9s);
  ck_assert_double_eq_tol(walker.stance().gesture, 1, 1e-9);
}
END_TEST

START_TEST(any_steps_of_time_give_the_same_walk) {
  const std::vector<I> way{{I::go, 3, 1, 1.2}, {I::go, 0, 2, .5, 0, true}, {I::stand}};
  Walker one(0, 0, 1, way, {}), many(0, 0, 1, way, {});
  one.elapse(7s);
  for (cerberus::motion::Time t = 0ms; t <= 7s; t += 7ms) many.elapse(t);
  many.elapse(7s);
  ck_assert(one.stance().x == many.stance().x && one.stance().y == many.stance().y);
  ck_assert(one.stance().phase == many.stance().phase);
}
END_TEST

START_TEST(a_body_is_as_tall_as_asked_and_48_centimetres_wide) {
  for (const double height : {1.5, 1.75, 1.9}) {
    Stance stance;
    stance.heading = std::numbers::pi / 2;  // along y: its width is along x
    double left = 0, right = 0, top = 0, low = 1;
    for (const Limb& limb : body_of(stance, height).limbs)
      for (const auto& [p, r] : {std::pair{limb.from, limb.wide_from}, std::pair{limb.to, limb.wide_to}}) {
        left = std::min(left, p.x - r), right = std::max(right, p.x + r);
        top = std::max(top, p.z + limb.cap * r), low = std::min(low, p.z - r);
      }
    ck_assert_double_eq_tol(right - left, .48, .02);
    ck_assert_double_eq_tol(top, height, .03 * height);
    ck_assert_double_eq_tol(low, 0, .02);
  }
}
END_TEST

START_TEST(the_feet_of_a_walker_part_by_a_step_and_one_is_on_the_floor) {
  for (const double speed : {.5, 1.4}) {
    Stance stance;
    stance.speed = speed, stance.step = .42 * 1.75 * std::sqrt(speed / 1.4);
    double widest = 0;
    for (stance.phase = 0; stance.phase < 2 * std::numbers::pi; stance.phase += .1) {
      double ankles[2], low = 1;
      int feet = 0;
      for (const Limb& limb : body_of(stance, 1.75).limbs)
        if (limb.part == Part::shoes) {
          low = std::min({low, limb.from.z, limb.to.z});
          ankles[feet++] = limb.from.x;
        }
      ck_assert_int_eq(feet, 2);
      ck_assert_double_eq_tol(low, .04, .02);
      widest = std::max(widest, std::abs(ankles[0] - ankles[1]));
    }
    ck_assert_double_eq_tol(widest, stance.step, .15 * stance.step + .03);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "house_people",
      {a_walker_keeps_its_speed_and_acceleration_between_its_places, a_walker_stands_and_gestures_as_told,
       any_steps_of_time_give_the_same_walk, a_body_is_as_tall_as_asked_and_48_centimetres_wide,
       the_feet_of_a_walker_part_by_a_step_and_one_is_on_the_floor});
}
