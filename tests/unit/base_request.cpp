// SPDX-License-Identifier: LGPL-2.1-or-later
// A head of +-170 degrees on a base that may be asked for 30 degrees a second.
#include "control/following/base_request.h"

#include <check.h>

#include <cmath>
#include <limits>

#include "support/suite.h"

using namespace cerberus::control;
using cerberus::motion::AxisLimits;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;

namespace {

const AxisLimits kLimits{radians(-170), radians(170)};

double ask(BaseRequest& request, double target, double rate = 0, const AxisLimits& limits = kLimits,
           double most = 30) {
  return degrees(request.update(radians(target), radians(rate), limits, radians(most)));
}

}  // namespace

START_TEST(the_base_is_asked_from_near_the_stop_on_until_there_is_room) {
  for (const double side : {1., -1.}) {
    BaseRequest request;
    ck_assert_double_eq(ask(request, side * 149), 0);
    ck_assert_double_eq_tol(ask(request, side * 151), side * 26, 1e-9);  // 151 - 125
    ck_assert_double_eq_tol(ask(request, side * 160), side * 30, 1e-9);  // no more than that
    ck_assert_double_eq_tol(ask(request, side * 140), side * 15, 1e-9);
    ck_assert_double_eq(ask(request, side * 124), 0);
    ck_assert_double_eq(ask(request, side * 140), 0);  // it begins near the stop
  }
}
END_TEST

START_TEST(a_target_that_goes_there_is_met_earlier) {
  BaseRequest request;
  ck_assert_double_eq_tol(ask(request, 140, 20), 29, 1e-9);  // 154 in .7 s
  request.end();
  ck_assert_double_eq(ask(request, 155, -20), 0);  // 141
}
END_TEST

START_TEST(narrow_limits_leave_half_of_them) {
  const AxisLimits narrow{radians(-60), radians(60)};
  BaseRequest request;
  ck_assert_double_eq_tol(ask(request, 46, 0, narrow), 16, 1e-9);
  ck_assert_double_eq(ask(request, 30, 0, narrow), 0);
  ck_assert_double_eq(ask(request, 44, 0, narrow), 0);  // it begins a quarter before the stop
  const AxisLimits narrower{radians(-4), radians(4)};
  ck_assert_double_eq(ask(request, -2.9, 0, narrower), 0);
  ck_assert_double_eq_tol(ask(request, -6, 0, narrower), -4, 1e-9);
}
END_TEST

START_TEST(nothing_is_asked_for_by_default_or_by_strange_numbers) {
  BaseRequest request;
  ck_assert_double_eq(ask(request, 180, 0, kLimits, 0), 0);
  ck_assert_double_eq_tol(ask(request, 180), 30, 1e-9);
  ck_assert_double_eq(ask(request, std::numeric_limits<double>::quiet_NaN()), 0);
  ck_assert_double_eq(ask(request, 130), 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "base_request",
      {the_base_is_asked_from_near_the_stop_on_until_there_is_room, a_target_that_goes_there_is_met_earlier,
       narrow_limits_leave_half_of_them, nothing_is_asked_for_by_default_or_by_strange_numbers});
}
