// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/height_prior.h"

#include <check.h>

#include <cmath>
#include <random>

#include "support/motions.h"
#include "support/suite.h"

using namespace cerberus::vision;

namespace {

// A camera twice as high as a person is tall, horizon 20 rows above the picture: h = (foot + 20) / 2.
double truth(double foot) {
  return (foot + 20) / 2;
}

void teach(HeightPrior& prior, int people, double from, double to, double outliers, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> row(from, to), share(0, 1), any(5, 120);
  std::normal_distribution<double> spread(1, 0.06);
  for (int i = 0; i < people; ++i) {
    const double foot = row(random);
    prior.learn(foot, share(random) < outliers ? any(random) : truth(foot) * spread(random));
  }
}

}  // namespace

START_TEST(the_height_is_unknown_before_eight_samples_agree) {
  HeightPrior prior;
  ck_assert_double_eq(prior.height(100), 0);
  teach(prior, 7, 60, 200, 0, 1);
  ck_assert(!prior.ready());
  ck_assert_double_eq(prior.height(100), 0);
  teach(prior, 20, 60, 200, 0, 2);
  ck_assert(prior.ready());
}
END_TEST

START_TEST(the_line_is_found_among_four_wrong_of_ten) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    HeightPrior prior;
    teach(prior, 120, 60, 200, 0.4, seed);
    for (const double foot : {70.0, 100.0, 150.0, 200.0}) {
      ck_assert_double_ge(prior.height(foot), 0.92 * truth(foot));
      ck_assert_double_le(prior.height(foot), 1.08 * truth(foot));
    }
  }
}
END_TEST

START_TEST(heights_without_order_give_no_line) {
  int spoke = 0;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    HeightPrior prior;
    teach(prior, 200, 60, 200, 1, seed);
    spoke += prior.ready();
  }
  ck_assert_int_eq(spoke, 0);
}
END_TEST

START_TEST(a_prior_learnt_in_one_row_is_unknown_in_rows_far_away) {
  HeightPrior prior;
  teach(prior, 60, 148, 152, 0, 3);
  ck_assert_double_ge(prior.height(150), 0.93 * truth(150));
  ck_assert_double_le(prior.height(150), 1.07 * truth(150));
  ck_assert_double_eq(prior.height(30), 0);
  ck_assert_double_eq(prior.height(600), 0);
}
END_TEST

// Of n alike samples in one row the mean has an error of .1 x sqrt(2 / n), and the slope is known from the horizon alone,
// which is as uncertain as twice its distance: 10 rows further on, 2 x 10 / 150 of a height.
START_TEST(the_line_is_as_uncertain_as_its_samples_are_few_and_far_away) {
  HeightPrior prior;
  for (int i = 0; i < 16; ++i) prior.learn(150, 75);
  const double error = 0.1 * std::sqrt(2 / 16.0);
  ck_assert_double_eq_tol(prior.uncertainty(150), error, 1e-6);
  const double there = prior.height(160);
  ck_assert_double_eq_tol(there, 80, 1e-6);
  ck_assert_double_eq_tol(prior.uncertainty(160) * there, std::hypot(error * 75, 2 * 10.0 / 150 * 75), 1e-5);
}
END_TEST

START_TEST(the_line_moves_with_the_camera) {
  HeightPrior prior;
  teach(prior, 100, 60, 200, 0, 4);
  const double before = prior.height(120);
  for (int i = 0; i < 10; ++i) prior.advance(Transform::translation(7, -3), {320, 240});
  ck_assert_double_eq_tol(prior.height(90), before, 1e-6);
  // And the samples with it: learning goes on from there.
  std::mt19937 random(5);
  for (int i = 0; i < 100; ++i) {
    const double foot = 30 + static_cast<double>(random() % 140);
    prior.learn(foot, truth(foot + 30));
  }
  ck_assert_double_eq_tol(prior.height(90), truth(120), 0.05 * truth(120));
}
END_TEST

START_TEST(a_zoom_about_the_middle_scales_heights_and_rows) {
  HeightPrior prior;
  teach(prior, 100, 60, 200, 0, 6);
  const double before = prior.height(160);
  // Twice about (160, 120): row 160 becomes 200.
  const Transform zoom = cerberus::tests::similarity(1.25, 0, 160 - 1.25 * 160, 120 - 1.25 * 120);
  prior.advance(zoom, {320, 240});
  ck_assert_double_eq_tol(prior.height(120 + 1.25 * 40), 1.25 * before, 1e-6);
}
END_TEST

START_TEST(a_new_truth_replaces_an_old_one) {
  HeightPrior prior;
  teach(prior, 256, 60, 200, 0, 7);
  for (int i = 0; i < 256; ++i) prior.learn(60 + i % 140, 1.6 * truth(60 + i % 140));
  ck_assert_double_eq_tol(prior.height(130), 1.6 * truth(130), 0.05 * truth(130));
  prior.reset();
  ck_assert_double_eq(prior.height(130), 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "height_prior",
      {the_height_is_unknown_before_eight_samples_agree, the_line_is_found_among_four_wrong_of_ten,
       heights_without_order_give_no_line, a_prior_learnt_in_one_row_is_unknown_in_rows_far_away,
       the_line_is_as_uncertain_as_its_samples_are_few_and_far_away, the_line_moves_with_the_camera,
       a_zoom_about_the_middle_scales_heights_and_rows, a_new_truth_replaces_an_old_one});
}
