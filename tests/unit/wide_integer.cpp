// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/wide_integer.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

START_TEST(sums_carry_into_the_next_digit) {
  WideInteger sum = 0xffffffffffffffff;
  sum += 1;
  ck_assert(sum == WideInteger(1ull << 32) * WideInteger(1ull << 32));
  ck_assert_double_eq(sum.to_double(), 18446744073709551616.0);
  sum += 0;
  ck_assert_double_eq(sum.to_double(), 18446744073709551616.0);
}
END_TEST

START_TEST(products_are_ordered_by_their_last_digit) {
  // (2^63 + 1)^8 > (2^63 + 1)^7 2^63 > 2^504, equal to 53 bits.
  const std::uint64_t top = 1ull << 63;
  WideInteger a = 1, b = 1, c = 1;
  for (int k = 0; k < 8; ++k) a = a * (top + 1), b = b * (k ? top + 1 : top), c = c * top;
  ck_assert(a > b && b > c && c < a);
  ck_assert(a == a && !(a == b));
  ck_assert_double_eq(a.to_double(), c.to_double());
  // (x + 1)(x - 1) = x^2 - 1
  WideInteger square = WideInteger(top + 1) * WideInteger(top - 1);
  ck_assert(square < WideInteger(top) * top);
  square += 1;
  ck_assert(square == WideInteger(top) * top);
}
END_TEST

START_TEST(zero_is_below_everything_and_makes_zero) {
  const WideInteger zero, large = WideInteger(~0ull) * ~0ull;
  ck_assert(zero == WideInteger(0) && zero < WideInteger(1));
  ck_assert(large * zero == zero);
  ck_assert_double_eq(zero.to_double(), 0);
}
END_TEST

int main() {
  return run_suite("wide_integer", {sums_carry_into_the_next_digit, products_are_ordered_by_their_last_digit,
                                    zero_is_below_everything_and_makes_zero});
}
