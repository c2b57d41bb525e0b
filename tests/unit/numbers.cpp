// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbers as text, against what printf() writes where the locale is C's.
#include "text/numbers.h"
#include "text/utc.h"

#include <check.h>

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>

#include "support/allocations.h"
#include "support/german.h"
#include "support/suite.h"

using namespace cerberus;

namespace {

void assert_is(const text::Digits& digits, const char* expected) {
  const std::string found = digits.string();
  ck_assert_str_eq(found.c_str(), expected);
  ck_assert(std::string_view(digits) == found);
}

}  // namespace

START_TEST(each_way_of_writing_has_its_use) {
  assert_is(text::exact(0.1), "0.1");
  assert_is(text::exact(-29.999999999999986), "-29.999999999999986");
  assert_is(text::rounded(-29.999999999999986, 6), "-30");
  assert_is(text::rounded(12.3456, 2), "12.35");
  assert_is(text::fixed(12, 1), "12.0");
  assert_is(text::fixed(12.34, 1), "12.3");
  assert_is(text::significant(27.0512, 4), "27.05");
  assert_is(text::significant(80, 4), "80");
  assert_is(text::significant(1234567, 3), "1.23e+06");
}
END_TEST

START_TEST(a_point_of_time_is_iso_8601) {
  using namespace std::chrono_literals;
  const auto is = [](std::chrono::nanoseconds time, const char* expected) {
    return std::string_view(text::Utc(time)) == expected;
  };
  ck_assert(is(0ns, "1970-01-01T00:00:00.000000Z"));
  ck_assert(is(1700000000123456789ns, "2023-11-14T22:13:20.123456Z"));
  ck_assert(is(951782399s + 999999999ns, "2000-02-28T23:59:59.999999Z"));
  ck_assert(is(951782400s, "2000-02-29T00:00:00.000000Z"));  // a leap day
  ck_assert(is(-1ns, "1969-12-31T23:59:59.999999Z"));
}
END_TEST

START_TEST(no_zero_is_below_zero) {
  assert_is(text::exact(-0.0), "0");
  assert_is(text::rounded(-0.001, 2), "0");
  assert_is(text::fixed(-0.0, 1), "0.0");
  assert_is(text::fixed(-0.03, 1), "0.0");
  assert_is(text::fixed(-0.06, 1), "-0.1");
  assert_is(text::fixed(-0.5, 0), "0");  // half way goes to the even one
  assert_is(text::fixed(-1e-300, 3), "0.000");
  assert_is(text::significant(-0.0, 3), "0");
}
END_TEST

START_TEST(whatever_number_it_is_there_is_room_for_it) {
  const double most = std::numeric_limits<double>::max(), least = std::numeric_limits<double>::denorm_min();
  for (const double value : {most, -most, least, -least, 1e15, -1e22, 1.0 / 3}) {
    const text::Digits all[] = {text::exact(value), text::rounded(value, 9), text::fixed(value, 9),
                                text::significant(value, 17)};
    for (const text::Digits& digits : all)
      ck_assert(std::isfinite(std::strtod(digits.string().c_str(), nullptr)));
    ck_assert(std::strtod(text::exact(value).string().c_str(), nullptr) == value);
  }
  assert_is(text::fixed(most, 2), "1.7976931348623157e+308");
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), HUGE_VAL, -HUGE_VAL})
    ck_assert(!std::isfinite(std::strtod(text::rounded(value, 3).string().c_str(), nullptr)));
}
END_TEST

START_TEST(it_is_what_printf_writes_in_c_and_the_same_in_germany) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> some(-1e4, 1e4);
  for (int i = 0; i < 10000; ++i) {
    const double value = some(random);
    char digits[64];
    std::snprintf(digits, sizeof digits, "%.4g", value);
    assert_is(text::significant(value, 4), digits);
    std::snprintf(digits, sizeof digits, "%.1f", value);
    const bool negative_zero = std::string_view(digits) == "-0.0";
    assert_is(text::fixed(value, 1), negative_zero ? "0.0" : digits);
  }
  if (const tests::German german; german) assert_is(text::fixed(1.5, 1), "1.5");
}
END_TEST

START_TEST(nothing_is_allocated) {
  const auto before = tests::allocations();
  std::size_t length = 0;
  for (const double value : {1.0 / 3, 1e300}) length += std::string_view(text::fixed(value, 9)).size();
  ck_assert(length > 0);
  ck_assert_uint_eq(tests::allocations(), before);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "numbers", {each_way_of_writing_has_its_use, a_point_of_time_is_iso_8601, no_zero_is_below_zero,
                  whatever_number_it_is_there_is_room_for_it,
                  it_is_what_printf_writes_in_c_and_the_same_in_germany, nothing_is_allocated});
}
