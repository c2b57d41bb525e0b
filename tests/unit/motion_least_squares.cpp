// SPDX-License-Identifier: LGPL-2.1-or-later
// Motion of least squares, on normal equations solved by hand.
#include "vision/ego_motion/motion_least_squares.h"

#include <check.h>

#include <limits>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr MotionModel kModels[] = {MotionModel::translation, MotionModel::similarity, MotionModel::affine,
                                   MotionModel::homography};

}  // namespace

// 100 samples in the middle that all moved by (3, -2): a p = b with a = 100 for both shifts. The priors take away less
// than a thousandth of a pixel.
START_TEST(a_shift_of_all_samples_is_the_motion_whatever_the_model) {
  const MotionLeastSquares squares({320, 240});
  MotionNormal normal;
  normal.a[0][0] = normal.a[1][1] = 100;
  normal.b[0] = 300;
  normal.b[1] = -200;
  for (const MotionModel model : kModels) {
    Transform motion;
    ck_assert(squares.step(model, normal, motion));
    const Point moved = motion.apply({100, 50});
    ck_assert_double_eq_tol(moved.x, 103, 1e-3);
    ck_assert_double_eq_tol(moved.y, 48, 1e-3);
  }
}
END_TEST

START_TEST(equations_that_are_not_positive_definite_give_no_motion_and_change_nothing) {
  const MotionLeastSquares squares({320, 240});
  for (const double wrong : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    MotionNormal normal;
    normal.a[0][0] = wrong;
    for (const MotionModel model : kModels) {
      Transform motion = Transform::translation(7, 0);
      ck_assert(!squares.step(model, normal, motion));
      ck_assert_double_eq(motion.apply({0, 0}).x, 7);
    }
    for (const Shutter shutter : {Shutter::global, Shutter::rolling}) {
      Transform motion = Transform::translation(7, 0);
      LensBend lens{};
      ck_assert(!squares.step_turned(normal, shutter, lens, motion));
      ck_assert_double_eq(motion.apply({0, 0}).x, 7);
    }
  }
  Transform motion;
  ck_assert(!squares.step(MotionModel::none, {}, motion));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "motion_least_squares", {a_shift_of_all_samples_is_the_motion_whatever_the_model,
                               equations_that_are_not_positive_definite_give_no_motion_and_change_nothing});
}
