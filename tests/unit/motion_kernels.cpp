// SPDX-License-Identifier: LGPL-2.1-or-later
// The vector kernels of the camera motion estimate against plain loops, on memory that ends at an unreadable page.
#include "vision/ego_motion/motion_kernels.h"
#include "vision/image/filter_kernels.h"

#include <check.h>

#include <cmath>

#include "support/pictures.h"
#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(halving_is_the_rounded_mean_of_four) {
  std::mt19937 random(1);
  for (int width = 1; width < 140; ++width) {
    const GuardedPicture from({2 * width, 2}), to({width, 1});
    fill_random(from.view(), random);
    halve_rows(from.view().row(0), from.view().row(1), width, to.view().row(0));
    for (int x = 0; x < width; ++x) {
      const GrayView v = from.view();
      ck_assert_int_eq(to.view().at(x, 0),
                       (v.at(2 * x, 0) + v.at(2 * x + 1, 0) + v.at(2 * x, 1) + v.at(2 * x + 1, 1) + 2) / 4);
    }
  }
}
END_TEST

START_TEST(truncated_differences_are_summed) {
  std::mt19937 random(2);
  for (int count = 16; count <= 96; count += 16)
    for (const int limit : {0, 1, 63, 255}) {
      const GuardedPicture a({count, 3}, 5), b({count, 3}, 7);
      fill_random(a.view(), random), fill_random(b.view(), random);
      std::uint32_t expected = 0;
      for (int y = 0; y < 3; ++y)
        for (int x = 0; x < count; ++x)
          expected += std::min(std::abs(a.view().at(x, y) - b.view().at(x, y)), limit);
      ck_assert_uint_eq(truncated_difference(a.view().data, count + 5, b.view().data, count + 7, count, 3,
                                             static_cast<std::uint8_t>(limit)),
                        expected);
    }
}
END_TEST

START_TEST(gradient_blocks_are_sums_of_products_of_differences) {
  std::mt19937 random(3);
  for (int blocks = 1; blocks < 12; ++blocks) {
    const GuardedPicture picture({4 * blocks + 2, 6}, 5);
    fill_random(picture.view(), random);
    std::int32_t xx[12], xy[12], yy[12];
    sum_gradient_blocks(picture.view(), 1, 1, blocks, xx, xy, yy);
    for (int b = 0; b < blocks; ++b) {
      int exx = 0, exy = 0, eyy = 0;
      for (int y = 1; y < 5; ++y)
        for (int x = 4 * b + 1; x < 4 * b + 5; ++x) {
          const GrayView v = picture.view();
          const int gx = v.at(x + 1, y) - v.at(x - 1, y), gy = v.at(x, y + 1) - v.at(x, y - 1);
          exx += gx * gx, exy += gx * gy, eyy += gy * gy;
        }
      ck_assert_int_eq(xx[b], exx);
      ck_assert_int_eq(xy[b], exy);
      ck_assert_int_eq(yy[b], eyy);
    }
  }
}
END_TEST

START_TEST(a_template_holds_value_and_gradients_without_their_means) {
  std::mt19937 random(4);
  const GuardedPicture picture({kPatch + 2, kPatch + 2});
  fill_random(picture.view(), random);
  PatchTemplate patch;
  make_template(picture.view(), 1, 1, patch);
  const GrayView v = picture.view();
  double value = 0, gx = 0, gy = 0;
  for (int y = 1; y <= kPatch; ++y)
    for (int x = 1; x <= kPatch; ++x) {
      value += v.at(x, y) / 64.0;
      gx += (v.at(x + 1, y) - v.at(x - 1, y)) / 128.0;
      gy += (v.at(x, y + 1) - v.at(x, y - 1)) / 128.0;
    }
  double xx = 0, xy = 0, yy = 0, xv = 0, yv = 0, vv = 0;
  for (int y = 1; y <= kPatch; ++y)
    for (int x = 1; x <= kPatch; ++x) {
      const int i = (y - 1) * kPatch + x - 1;
      ck_assert_double_eq_tol(patch.value[i], v.at(x, y) - value, 1e-3);
      ck_assert_double_eq_tol(patch.gx[i], (v.at(x + 1, y) - v.at(x - 1, y)) / 2.0 - gx, 1e-3);
      ck_assert_double_eq_tol(patch.gy[i], (v.at(x, y + 1) - v.at(x, y - 1)) / 2.0 - gy, 1e-3);
      xx += double{patch.gx[i]} * patch.gx[i];
      xy += double{patch.gx[i]} * patch.gy[i];
      yy += double{patch.gy[i]} * patch.gy[i];
      vv += double{patch.value[i]} * patch.value[i];
      xv += double{patch.gx[i]} * patch.value[i];
      yv += double{patch.gy[i]} * patch.value[i];
    }
  ck_assert_double_eq_tol(patch.xx, xx, 1e-5 * xx);
  ck_assert_double_eq_tol(patch.xy, xy, 1e-5 * xx);
  ck_assert_double_eq_tol(patch.yy, yy, 1e-5 * xx);
  ck_assert_double_eq_tol(patch.vv, vv, 1e-5 * vv);
  ck_assert_double_eq_tol(patch.xv, xv, 1e-5 * xx);
  ck_assert_double_eq_tol(patch.yv, yv, 1e-5 * xx);
}
END_TEST

START_TEST(matching_gives_the_inner_products_with_the_interpolated_picture) {
  std::mt19937 random(5);
  const GuardedPicture earlier({kPatch + 2, kPatch + 2}), later({kPatch + 4, kPatch + 4});
  fill_random(earlier.view(), random), fill_random(later.view(), random);
  PatchTemplate patch;
  make_template(earlier.view(), 1, 1, patch);
  const GrayView v = later.view();
  const float places[][2] = {
      {0, 0}, {0.25f, 1.5f}, {2.75f, 0.125f}, {3, 3}};  // the last one ends with the memory
  for (const auto& at : places) {
    const PatchProducts p = match_patch(v, at[0], at[1], patch);
    double with_x = 0, with_y = 0, with_value = 0, sum = 0, squares = 0;
    for (int j = 0; j < kPatch; ++j)
      for (int i = 0; i < kPatch; ++i) {
        const int x = static_cast<int>(at[0]) + i, y = static_cast<int>(at[1]) + j;
        const double fx = at[0] - std::floor(at[0]), fy = at[1] - std::floor(at[1]);
        const double value = (v.at(x, y) * (1 - fx) + v.at(x + 1, y) * fx) * (1 - fy) +
                             (v.at(x, y + 1) * (1 - fx) + v.at(x + 1, y + 1) * fx) * fy;
        with_x += value * patch.gx[j * kPatch + i], with_y += value * patch.gy[j * kPatch + i];
        with_value += value * patch.value[j * kPatch + i];
        sum += value, squares += value * value;
      }
    ck_assert_double_eq_tol(p.x, with_x, 2.0);
    ck_assert_double_eq_tol(p.y, with_y, 2.0);
    ck_assert_double_eq_tol(p.value, with_value, 2.0);
    ck_assert_double_eq_tol(p.sum, sum, 0.1);
    ck_assert_double_eq_tol(p.squares, squares, 1e-5 * squares);
  }
}
END_TEST

int main() {
  return run_suite_on_every_target("motion_kernels",
                                   {halving_is_the_rounded_mean_of_four, truncated_differences_are_summed,
                                    gradient_blocks_are_sums_of_products_of_differences,
                                    a_template_holds_value_and_gradients_without_their_means,
                                    matching_gives_the_inner_products_with_the_interpolated_picture});
}
