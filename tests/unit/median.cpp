// SPDX-License-Identifier: LGPL-2.1-or-later
// Medians by hand, and noise of known strength.
#include "vision/image/median.h"

#include <array>
#include <cmath>
#include <random>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(the_median_lies_where_half_of_the_counts_are_reached) {
  // 40 counts of the levels -1, 0 and 1: half is reached in the middle of 0, which stands for -0.5 to 0.5.
  ck_assert_double_eq_tol(median_of_levels(std::array{10, 20, 10}, 40, -1), 0, 1e-12);
  // 20 of 25 into level 0.
  ck_assert_double_eq_tol(median_of_levels(std::array{0, 25, 15}, 40, -1), 0.3, 1e-12);
  // No value is between: the end of the lower level.
  ck_assert_double_eq_tol(median_of_levels(std::array{20, 0, 20}, 40, -1), -0.5, 1e-12);
  ck_assert_double_eq(median_of_levels(std::array{0, 0, 0}, 40), 0);
}
END_TEST

START_TEST(noise_is_the_scaled_median_of_absolute_values) {
  // Half of 40 is reached in the middle of level 1, which stands for 0.5 to 1.5.
  ck_assert_double_eq_tol(noise_sigma(std::array{10, 20, 10}), 1.4826 * 1.0, 1e-12);
  // 25 of 40 into level 0, which stands for 0 to 0.5.
  ck_assert_double_eq_tol(noise_sigma(std::array{40, 0, 0, 10}), 1.4826 * 0.5 * 25 / 40, 1e-12);
  ck_assert_double_eq(noise_sigma(std::array{0, 0}), 0);
}
END_TEST

START_TEST(noise_of_rounded_normal_differences_is_recovered) {
  std::mt19937 random(11);
  for (const double sigma : {0.8, 2.0, 5.0}) {
    std::normal_distribution<double> normal(0, sigma);
    std::array<unsigned, 256> counts{};
    for (int i = 0; i < 200000; ++i)
      ++counts[static_cast<std::size_t>(std::min(255L, std::lround(std::abs(normal(random)))))];
    ck_assert_double_eq_tol(noise_sigma(counts), sigma, 0.06 * sigma);
  }
}
END_TEST

int main() {
  return run_suite("median", {the_median_lies_where_half_of_the_counts_are_reached,
                              noise_is_the_scaled_median_of_absolute_values,
                              noise_of_rounded_normal_differences_is_recovered});
}
