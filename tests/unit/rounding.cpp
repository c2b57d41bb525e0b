// SPDX-License-Identifier: LGPL-2.1-or-later
// Rounding against the library's.
#include "vision/image/rounding.h"

#include <check.h>

#include <cmath>
#include <random>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(halves_go_away_from_zero_and_what_is_just_below_does_not) {
  for (const double whole : {0.0, 1.0, 2.0, 255.0, 2147483646.0})
    for (const double value :
         {whole, whole + 0.5, std::nextafter(whole + 0.5, 0), std::nextafter(whole + 0.5, 1e9)}) {
      ck_assert_int_eq(round_to_int(value), std::lround(value));
      ck_assert_int_eq(round_to_int(-value), std::lround(-value));
    }
}
END_TEST

START_TEST(any_number_is_rounded_as_the_library_does) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> near(-3, 3), far(-1e9, 1e9);
  for (int i = 0; i < 100000; ++i)
    for (const double value : {near(random), far(random)})
      ck_assert_int_eq(round_to_int(value), std::lround(value));
}
END_TEST

int main() {
  return run_suite("rounding", {halves_go_away_from_zero_and_what_is_just_below_does_not,
                                any_number_is_rounded_as_the_library_does});
}
