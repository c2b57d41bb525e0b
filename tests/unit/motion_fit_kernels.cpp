// SPDX-License-Identifier: LGPL-2.1-or-later
// The kernels of the motion's fit against their scalar references, on every vector target of this processor, and the
// references against values computed by hand.
#include "vision/ego_motion/motion_fit_kernels.h"

#include <check.h>

#include <cmath>
#include <random>

#include "support/motions.h"
#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr MotionScale kScale{159.5, 119.5, 1 / 200.0};

// Half of them follow `motion`, more or less; `regions` of the picture have any.
MotionSamples any_samples(int count, int regions, const Transform& motion, std::mt19937& random) {
  std::uniform_real_distribution<float> share(0, 1);
  std::normal_distribution<float> normal;
  MotionSamples s;
  s.count = count;
  for (int i = 0; i < count; ++i) {
    s.x[i] = 320 * share(random), s.y[i] = 240 * share(random);
    const Point p = motion.apply({s.x[i], s.y[i]});
    const float off = i % 2 ? 0.2f : 20.0f;
    s.u[i] = static_cast<float>(p.x) + off * normal(random);
    s.v[i] = static_cast<float>(p.y) + off * normal(random);
    s.wxx[i] = 1 + 30 * share(random), s.wyy[i] = 1 + 30 * share(random);
    s.wxy[i] = (2 * share(random) - 1) * std::sqrt(s.wxx[i] * s.wyy[i]);
    s.evidence[i] = 0.05f + 0.95f * share(random);
    s.region[i] = static_cast<std::uint8_t>(random() % static_cast<unsigned>(regions));
  }
  return s;
}

const Transform kMotions[]{
    {}, similarity(1.04, 0.05, -12, 7), {{1.02, 0.01, 8, 0.005, 1.01, -3, 1e-4, -5e-5, 1}}};

// Floats of coordinates of hundreds of pixels are off by some 1e-5 pixels.
void assert_near(double value, double expected, double scale) {
  ck_assert_double_eq_tol(value, expected, 2e-4 * scale);
}

// One sample in the middle of each region but the last; its covariance is 0.1 pixels in both directions.
MotionSamples one_of_each() {
  MotionSamples s;
  s.count = MotionSamples::kRegions - 1;
  for (int i = 0; i < s.count; ++i) {
    s.x[i] = s.u[i] = static_cast<float>(40 + 80 * (i % 4)),
    s.y[i] = s.v[i] = static_cast<float>(30 + 60 * (i / 4));
    s.wxx[i] = s.wyy[i] = 100, s.wxy[i] = 0;
    s.evidence[i] = 0.5f, s.region[i] = static_cast<std::uint8_t>(i);
  }
  return s;
}

}  // namespace

START_TEST(agreement_agrees_with_the_reference) {
  std::mt19937 random(1);
  for (const Transform& motion : kMotions)
    for (const int count : {0, 1, 15, 16, 17, 100, MotionSamples::kMax})
      for (const int regions : {1, 3, 16}) {
        const SampleRows rows(any_samples(count, regions, motion, random));
        const Agreement fast = agreement_with(rows, motion), slow = agreement_with_reference(rows, motion);
        for (int r = 0; r < MotionSamples::kRegions; ++r)
          assert_near(fast.of_region[r], slow.of_region[r], 192);
        assert_near(fast.cost, slow.cost, 1000);
        assert_near(fast.agreeing, slow.agreeing, 192);
        assert_near(fast.squares, slow.squares, 192);
        ck_assert(fast.followers == slow.followers);
      }
}
END_TEST

START_TEST(normal_equations_agree_with_the_reference) {
  std::mt19937 random(2);
  for (const Transform& motion : kMotions)
    for (const int count : {0, 1, 17, MotionSamples::kMax})
      for (const int regions : {1, 16})
        for (const bool perspective : {false, true}) {
          const SampleRows rows(any_samples(count, regions, motion, random));
          const MotionNormal fast = sum_normal(rows, motion, 1.5f * kGate, kScale, perspective),
                             slow = sum_normal_reference(rows, motion, 1.5f * kGate, kScale, perspective);
          for (std::size_t i = 0; i < MotionNormal::kUnknowns; ++i) {
            for (std::size_t j = i; j < MotionNormal::kUnknowns; ++j)
              assert_near(fast.a[i][j], slow.a[i][j], 1 + slow.a[0][0] + slow.a[1][1]);
            assert_near(fast.b[i], slow.b[i], 10 * (1 + slow.a[0][0] + slow.a[1][1]));
          }
          if (!perspective) ck_assert(slow.a[6][6] == 0 && fast.a[6][6] == 0 && fast.b[7] == 0);
        }
}
END_TEST

START_TEST(agreement_is_summed_for_each_region) {
  MotionSamples s = one_of_each();
  s.u[3] += 0.15f;  // squared distance 2.25, a quarter of the gate's
  s.v[6] += 5;
  for (const Agreement& a :
       {agreement_with_reference(SampleRows(s), {}), agreement_with(SampleRows(s), {})}) {
    for (int r = 0; r < MotionSamples::kRegions; ++r)
      ck_assert_double_eq_tol(a.of_region[r], r == 3 ? 0.375 : r == 6 || r == 15 ? 0 : 0.5, 1e-4);
    ck_assert_double_eq_tol(a.cost, 0.5 * 2.25 + 0.5 * 9, 1e-3);
    ck_assert_double_eq_tol(a.agreeing, 7, 1e-5);
    ck_assert_double_eq_tol(a.squares, 0.5 * 0.15 * 0.15, 1e-4);
    ck_assert_int_eq(a.followers.count(), 14);
  }
}
END_TEST

START_TEST(a_follower_of_both_is_counted_in_every_row) {
  MotionSamples s = one_of_each();
  const int first = s.count;
  for (int i = first; i < MotionSamples::kMax; ++i) {  // far more than a region has room for
    s.x[i] = s.u[i] = s.y[i] = s.v[i] = 100;
    s.wxx[i] = s.wyy[i] = 100, s.wxy[i] = 0, s.evidence[i] = 1, s.region[i] = 5;
    if (i % 3 == 0) s.u[i] += 4;
  }
  s.count = MotionSamples::kMax;
  const SampleRows rows(s);
  const Agreement still = agreement_with(rows, {}),
                  moved = agreement_with(rows, Transform::translation(4, 0));
  ck_assert_int_eq(still.followers.count(), 15 + 118);  // of 177 from 15 on, 59 are divisible by three
  ck_assert_int_eq(moved.followers.count(), 59);
  ck_assert_int_eq(still.followers.common(moved.followers), 0);
  ck_assert_int_eq(still.followers.common(still.followers), 133);
  ck_assert_double_eq_tol(still.of_region[5], 118.5, 1e-3);
}
END_TEST

START_TEST(one_sample_gives_its_own_equations) {
  MotionSamples s;
  s.count = 1;
  s.x[0] = 259.5f, s.y[0] = 79.5f, s.u[0] = 261.5f, s.v[0] = 78.5f;  // (.5, -.2) to (.51, -.205)
  s.wxx[0] = 3, s.wxy[0] = 1, s.wyy[0] = 2, s.evidence[0] = 1, s.region[0] = 9;
  // Off by (1, 0) from a shift of (1, -1): squared distance 3 of a gate of 6, Tukey's weight a quarter.
  const SampleRows rows(s);
  for (const MotionNormal& n : {sum_normal_reference(rows, Transform::translation(1, -1), 6, kScale, true),
                                sum_normal(rows, Transform::translation(1, -1), 6, kScale, true)}) {
    ck_assert_double_eq_tol(n.a[0][0], 0.75, 1e-4);
    ck_assert_double_eq_tol(n.a[0][1], 0.25, 1e-4);
    ck_assert_double_eq_tol(n.a[1][1], 0.5, 1e-4);
    ck_assert_double_eq_tol(n.a[2][5], 0.25 * 1 * 0.5 * -0.2, 1e-4);
    ck_assert_double_eq_tol(n.b[0], 0.25 * (3 * 2 + 1 * -1), 1e-4);
    ck_assert_double_eq_tol(n.b[1], 0.25 * (1 * 2 + 2 * -1), 1e-4);
    ck_assert_double_eq_tol(n.a[0][6], -0.25 * 0.5 * (3 * 0.51 + 1 * -0.205), 1e-4);
    ck_assert_double_eq_tol(n.b[7], 0.25 * 0.2 * (0.51 * 5 - 0.205 * 0), 1e-4);
  }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "motion_fit_kernels", {agreement_agrees_with_the_reference, normal_equations_agree_with_the_reference,
                             agreement_is_summed_for_each_region, a_follower_of_both_is_counted_in_every_row,
                             one_sample_gives_its_own_equations});
}
