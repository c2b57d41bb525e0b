// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/geometry/transform.h"

#include <check.h>

#include <cmath>
#include <random>

#include "support/motions.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

void assert_point(Point p, double x, double y, double tolerance = 1e-9) {
  ck_assert_double_eq_tol(p.x, x, tolerance);
  ck_assert_double_eq_tol(p.y, y, tolerance);
}

Transform random_motion(std::mt19937& random) {
  std::uniform_real_distribution<double> u(-1, 1);
  Transform t = similarity(1 + 0.3 * u(random), u(random), 50 * u(random), 50 * u(random));
  t.m[6] = 4e-4 * u(random), t.m[7] = 4e-4 * u(random);
  return t;
}

}  // namespace

START_TEST(a_motion_turns_then_shifts) {
  const Transform t{{0, -2, 10, 2, 0, 20, 0, 0, 1}};  // x towards y, twice as far
  assert_point(t.apply({1, 0}), 10, 22);
  assert_point(t.apply({0, 1}), 8, 20);
  ck_assert(t.is_affine() && !t.is_identity());
  assert_point(Transform::translation(3, -4).apply({1, 1}), 4, -3);
}
END_TEST

START_TEST(the_product_applies_the_right_one_first) {
  const Transform turn = similarity(1, M_PI / 2, 0, 0), shift = Transform::translation(5, 0);
  assert_point((turn * shift).apply({0, 0}), 0, 5);
  assert_point((shift * turn).apply({0, 0}), 5, 0);
}
END_TEST

START_TEST(inverse_and_product_undo_and_compose_random_motions) {
  std::mt19937 random(1);
  for (int i = 0; i < 200; ++i) {
    const Transform a = random_motion(random), b = random_motion(random);
    const Point p{random() % 320 * 1.0, random() % 240 * 1.0};
    const Point q = a.inverse().apply(a.apply(p));
    assert_point(q, p.x, p.y, 1e-6);
    const Point composed = (a * b).apply(p), stepwise = a.apply(b.apply(p));
    assert_point(composed, stepwise.x, stepwise.y, 1e-6);
  }
  ck_assert((Transform{{0, 0, 0, 0, 0, 0, 0, 0, 0}}).inverse().is_identity());
}
END_TEST

START_TEST(rescaling_keeps_the_picture_of_the_motion) {
  // Pixel areas are aligned: the point in the middle of pixel x of the small picture is the middle of its block.
  std::mt19937 random(2);
  const Size small{320, 180}, large{1920, 1080};
  for (int i = 0; i < 50; ++i) {
    const Transform t = random_motion(random), up = t.rescaled(small, large);
    const Point p{100, 70}, q = t.apply(p);
    const Point moved = up.apply({(p.x + 0.5) * 6 - 0.5, (p.y + 0.5) * 6 - 0.5});
    assert_point(moved, (q.x + 0.5) * 6 - 0.5, (q.y + 0.5) * 6 - 0.5, 1e-6);
    const Point back = up.rescaled(large, small).apply(p);
    assert_point(back, q.x, q.y, 1e-6);
  }
  ck_assert(Transform{}.rescaled({854, 480}, {320, 180}).is_identity());  // exactly
  assert_point(Transform::translation(1, 1).rescaled({320, 180}, {640, 360}).apply({0, 0}), 2, 2);
}
END_TEST

START_TEST(only_motions_a_camera_can_make_are_sane) {
  const Size size{320, 240};
  ck_assert(Transform{}.is_sane(size));
  ck_assert(similarity(1.5, 2, 400, -30).is_sane(size));
  ck_assert((Transform{{1, 0, 0, 0, 1, 0, 1e-3, 0, 1}}).is_sane(size));
  ck_assert(!(Transform{{-1, 0, 0, 0, 1, 0, 0, 0, 1}}).is_sane(size));   // mirrored
  ck_assert(!(Transform{{1, 2, 0, 0.5, 1, 0, 0, 0, 1}}).is_sane(size));  // flat
  ck_assert(
      !(Transform{{1, 0, 0, 0, 1, 0, -1.0 / 200, 0, 1}}).is_sane(size));  // the horizon crosses the picture
  ck_assert(!(Transform{{1, 0, INFINITY, 0, 1, 0, 0, 0, 1}}).is_sane(size));
  ck_assert(!(Transform{{NAN, 0, 0, 0, 1, 0, 0, 0, 1}}).is_sane(size));
  ck_assert(!similarity(0.1, 0, 0, 0).is_sane(size));
  ck_assert(!similarity(10, 0, 0, 0).is_sane(size));
}
END_TEST

START_TEST(corner_motion_is_that_of_the_fastest_corner) {
  ck_assert_double_eq_tol(Transform::translation(3, 4).corner_motion({100, 50}), 5, 1e-12);
  ck_assert_double_eq_tol(similarity(1.1, 0, 0, 0).corner_motion({101, 1}), 10, 1e-9);
  ck_assert_double_eq(Transform{}.corner_motion({100, 50}), 0);
}
END_TEST

int main() {
  return run_suite(
      "transform",
      {a_motion_turns_then_shifts, the_product_applies_the_right_one_first,
       inverse_and_product_undo_and_compose_random_motions, rescaling_keeps_the_picture_of_the_motion,
       only_motions_a_camera_can_make_are_sane, corner_motion_is_that_of_the_fastest_corner});
}
