// SPDX-License-Identifier: LGPL-2.1-or-later
// The filter against the same estimate in one piece, and by hand. Seconds; the unit of an angle does not matter.
#include "control/following/target_filter.h"

#include <check.h>

#include <random>
#include <vector>

#include "support/suite.h"

using cerberus::control::TargetFilter;

namespace {

constexpr double kTolerance = 1e-9;

struct Line {
  double at_zero = 0, rate = 0;
};

// Least squares over all angles, the rate known beforehand to be 0 +- `rate`:
//   minimise  sum (z - x - v t)^2 / noise^2 + v^2 / rate^2
Line fit(const std::vector<double>& times, const std::vector<double>& angles, double noise, double rate) {
  double n = 0, t = 0, tt = noise * noise / (rate * rate), z = 0, tz = 0;
  for (std::size_t k = 0; k < times.size(); ++k) {
    n += 1;
    t += times[k];
    tt += times[k] * times[k];
    z += angles[k];
    tz += times[k] * angles[k];
  }
  const double determinant = n * tt - t * t;
  return {(z * tt - t * tz) / determinant, (n * tz - t * z) / determinant};
}

}  // namespace

START_TEST(without_acceleration_it_is_least_squares_over_all_angles) {
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0, .3);
  std::uniform_real_distribution<double> step(.01, .4);
  for (const double speed : {0., .7, -2.}) {
    TargetFilter filter;
    std::vector<double> times, angles;
    // The rate was known at the first angle's time; that is time 0.
    for (double t = 0; times.size() < 30; t += step(random)) {
      times.push_back(t);
      angles.push_back(4 + speed * t + noise(random));
      filter.add(t, angles.back(), {.3, 0, 2});
    }
    const Line line = fit(times, angles, .3, 2);
    ck_assert_double_eq_tol(filter.rate(), line.rate, kTolerance);
    const double later = times.back() + .25;
    ck_assert_double_eq_tol(filter.at(later), line.at_zero + line.rate * later, kTolerance);
  }
}
END_TEST

// By hand, half a second later: P = 1 + 4/4 + 12/24 = 2.5, cross term 4/2 + 12/8 = 3.5, S = 3.5. Of an innovation of 3.5
// the angle takes 2.5 and the rate 3.5.
START_TEST(acceleration_is_the_continuous_white_noise_of_the_book) {
  TargetFilter filter;
  filter.add(10, 0, {1, 12, 2});
  filter.add(10.5, 3.5, {1, 12, 2});
  ck_assert_double_eq_tol(filter.at(10.5), 2.5, kTolerance);
  ck_assert_double_eq_tol(filter.rate(), 3.5, kTolerance);
}
END_TEST

START_TEST(one_wild_angle_is_left_out_and_the_third_in_a_row_begins_anew) {
  const TargetFilter::Parameters known{.01, .1, .5};
  TargetFilter filter;
  double t = 0;
  for (; t < 2; t += .04) filter.add(t, .3 * t, known);
  TargetFilter untouched = filter;
  filter.add(t, 3, known);
  ck_assert_double_eq_tol(filter.at(t + .1), untouched.at(t + .1), kTolerance);
  filter.add(t + .04, .3 * (t + .04), known);  // it goes on
  filter.add(t + .08, 3, known);
  filter.add(t + .12, 3, known);
  ck_assert_double_eq_tol(filter.at(t + .12), .3 * (t + .12), .02);
  filter.add(t + .16, 3.1, known);
  ck_assert_double_eq_tol(filter.at(t + .16), 3.1, kTolerance);
  ck_assert_double_eq_tol(filter.rate(), 0, kTolerance);
}
END_TEST

START_TEST(after_a_pause_nothing_is_left_of_the_old_motion) {
  TargetFilter filter;
  for (int k = 0; k < 50; ++k) filter.add(k * .04, k * .1, {.01, .1, 5});
  const double last = 49 * .04;
  filter.add(last + TargetFilter::kPause + .01, 7, {.01, .1, 5});
  ck_assert_double_eq_tol(filter.at(100), 7, kTolerance);
}
END_TEST

START_TEST(an_angle_that_is_not_later_is_ignored) {
  TargetFilter filter;
  filter.add(1, 2, {.1, 1, 1});
  filter.add(1, 3, {.1, 1, 1});
  filter.add(.9, 3, {.1, 1, 1});
  ck_assert_double_eq_tol(filter.at(1), 2, kTolerance);
  filter.reset();
  ck_assert(!filter.known());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "target_filter",
      {without_acceleration_it_is_least_squares_over_all_angles,
       acceleration_is_the_continuous_white_noise_of_the_book,
       one_wild_angle_is_left_out_and_the_third_in_a_row_begins_anew,
       after_a_pause_nothing_is_left_of_the_old_motion, an_angle_that_is_not_later_is_ignored});
}
