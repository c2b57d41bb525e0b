// SPDX-License-Identifier: LGPL-2.1-or-later
// The threshold by indices of fuzziness against an example computed by hand (fractions), and against the definition
// written out as sums.
#include "vision/change/fuzzy_threshold.h"

#include <check.h>

#include <cmath>
#include <random>

#include "support/allocations.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

const Histogram kExample{30, 60, 5, 4, 1, 5, 20, 12};

FuzzyThresholdOptions options(Weighting weighting, Extremes extremes, int order = 1) {
  FuzzyThresholdOptions o;
  o.weighting = weighting;
  o.extremes = extremes;
  o.order = order;
  o.clip = false;
  return o;
}

// psi of the levels for which in[x] holds, term by term from Eq. 4 and 7 to 9.
double psi_by_definition(const std::array<double, 256>& g, const std::array<bool, 256>& in, bool image,
                         int x0, int x1, int k) {
  double s = 0, xs = 0;
  int lo = 256, hi = -1;
  for (int x = 0; x < 256; ++x)
    if (in[x]) s += g[x], xs += x * g[x], lo = std::min(lo, x), hi = std::max(hi, x);
  if (s == 0) return 0;
  if (image) lo = x0, hi = x1;
  const double b = xs / s, c = b + std::max(std::abs(b - hi), std::abs(b - lo)), a = 2 * b - c;
  if (c == b) return 0;
  double sum = 0;
  for (int x = 0; x < 256; ++x) {
    if (!in[x]) continue;
    double mu = x < a    ? 0
                : x > c  ? 1
                : x <= b ? 2 * std::pow((x - a) / (c - a), 2)
                         : 1 - 2 * std::pow((x - c) / (c - a), 2);
    sum += g[x] * std::pow(std::abs(mu - (mu < 0.5 ? 0.0 : 1.0)), k);
  }
  return 2 * std::pow(sum / s, 1.0 / k);
}

}  // namespace

START_TEST(the_example_gives_4_by_counts) {
  FuzzyThresholdCurves c;
  ck_assert_int_eq(fuzzy_threshold(kExample, options(Weighting::linear, Extremes::subset), &c), 4);
  ck_assert_int_eq(c.lowest, 0);
  ck_assert_int_eq(c.seed_low, 1);
  ck_assert_int_eq(c.middle, 3);
  ck_assert_int_eq(c.seed_high, 6);
  ck_assert_int_eq(c.highest, 7);
  ck_assert_double_eq_tol(c.psi_background, 1.0 / 6, 1e-12);
  ck_assert_double_eq_tol(c.psi_object, 1.0 / 10, 1e-12);
  ck_assert_double_eq_tol(c.alpha, 3.0 / 5, 1e-12);
  const double beta[] = {411.0 / 1520, 22433.0 / 57575, 102377.0 / 227500, 15273.0 / 32110};
  const double omega[] = {22839.0 / 36260, 19.0 / 27, 10069.0 / 15884, 7433.0 / 17908};
  for (int x = 2; x <= 5; ++x) {
    ck_assert_double_eq_tol(c.beta[x], beta[x - 2], 1e-12);
    ck_assert_double_eq_tol(c.omega[x], omega[x - 2], 1e-12);
  }
}
END_TEST

START_TEST(the_example_gives_2_by_logarithms) {
  FuzzyThresholdCurves c;
  ck_assert_int_eq(fuzzy_threshold(kExample, options(Weighting::log, Extremes::subset), &c), 2);
  ck_assert_double_eq_tol(c.psi_background, .014772, 1e-6);
  ck_assert_double_eq_tol(c.psi_object, .013467, 1e-6);
  ck_assert_double_eq_tol(c.alpha, .911637, 1e-6);
  const double beta[] = {.320299, .491486, .614693, .442432}, omega[] = {.367541, .421845, .564613, .349619};
  for (int x = 2; x <= 5; ++x) {
    ck_assert_double_eq_tol(c.beta[x], beta[x - 2], 1e-6);
    ck_assert_double_eq_tol(c.omega[x], omega[x - 2], 1e-6);
  }
}
END_TEST

START_TEST(the_second_order_finds_no_object_in_the_example) {
  FuzzyThresholdCurves c;
  ck_assert_int_eq(fuzzy_threshold(kExample, options(Weighting::linear, Extremes::subset, 2), &c), 5);
  ck_assert_double_eq_tol(c.psi_background, .204124, 1e-6);
  ck_assert_double_eq_tol(c.psi_object, .126491, 1e-6);
}
END_TEST

START_TEST(the_extremes_of_the_image_turn_the_sign_at_5) {
  FuzzyThresholdCurves c;
  ck_assert_int_eq(fuzzy_threshold(kExample, options(Weighting::linear, Extremes::image), &c), 4);
  ck_assert_double_eq_tol(c.alpha, 537529.0 / 541586, 1e-12);
}
END_TEST

START_TEST(running_sums_agree_with_the_definition_on_random_histograms) {
  std::mt19937 random(5);
  for (int round = 0; round < 200; ++round) {
    Histogram h{};
    const int top = 8 + static_cast<int>(random() % 248);
    for (int x = 0; x < top; ++x)
      if (random() % 3) h[x] = random() % (1 + 20000 / (1 + x));
    const bool log = round & 1, image = round & 2;
    const int order = round & 4 ? 1 : 3;
    FuzzyThresholdCurves c;
    fuzzy_threshold(
        h,
        options(log ? Weighting::log : Weighting::linear, image ? Extremes::image : Extremes::subset, order),
        &c);
    std::array<double, 256> g{};
    for (int x = 0; x < 256; ++x) g[x] = log ? std::log1p(h[x]) : h[x];
    std::array<bool, 256> background{}, object{};
    for (int x = c.lowest; x <= c.seed_low; ++x) background[x] = true;
    for (int x = c.seed_high; x <= c.highest; ++x) object[x] = true;
    ck_assert_double_eq_tol(c.psi_background,
                            psi_by_definition(g, background, image, c.lowest, c.highest, order), 1e-9);
    ck_assert_double_eq_tol(c.psi_object, psi_by_definition(g, object, image, c.lowest, c.highest, order),
                            1e-9);
    for (int x = c.seed_low + 1; x < c.seed_high; ++x) {
      auto b = background, o = object;
      b[x] = o[x] = true;
      ck_assert_double_eq_tol(c.beta[x], c.alpha * psi_by_definition(g, b, image, c.lowest, c.highest, order),
                              1e-9);
      ck_assert_double_eq_tol(c.omega[x], psi_by_definition(g, o, image, c.lowest, c.highest, order), 1e-9);
    }
  }
}
END_TEST

START_TEST(degenerate_histograms_have_no_object) {
  const FuzzyThresholdOptions o;
  ck_assert_int_eq(fuzzy_threshold(Histogram{}, o), 0);
  Histogram h{};
  h[7] = 1000;
  ck_assert_int_eq(fuzzy_threshold(h, o), 7);
  h[9] = 1000;  // two levels apart: still below 3
  ck_assert_int_eq(fuzzy_threshold(h, o), 9);
}
END_TEST

START_TEST(one_hot_pixel_does_not_move_the_threshold) {
  Histogram h{};
  for (int x = 0; x < 24; ++x) h[x] = 40000u >> (x * 2 / 3);
  for (int x = 24; x < 60; ++x) h[x] = 20;
  const FuzzyThresholdOptions clipped;
  FuzzyThresholdOptions open;
  open.clip = false;
  const int before = fuzzy_threshold(h, clipped);
  h[255] = 1;
  ck_assert_int_eq(fuzzy_threshold(h, clipped), before);
  ck_assert_int_ne(fuzzy_threshold(h, open), before);  // the clip is what did it
}
END_TEST

START_TEST(the_threshold_is_held_between_the_floor_and_half_above_it) {
  ck_assert_int_eq(clamp_to_noise(2, 1.0), 6);   // the least floor
  ck_assert_int_eq(clamp_to_noise(80, 1.0), 9);  // 1.5 floors
  ck_assert_int_eq(clamp_to_noise(8, 1.0), 8);
  ck_assert_int_eq(clamp_to_noise(2, 5.0), 20);  // 4 sigma
  ck_assert_int_eq(clamp_to_noise(80, 5.0), 30);
  ck_assert_int_eq(clamp_to_noise(80, 500.0), 255);
}
END_TEST

START_TEST(nothing_is_allocated) {
  const auto before = allocations();
  fuzzy_threshold(kExample, {});
  ck_assert_uint_eq(allocations(), before);
}
END_TEST

int main() {
  return run_suite(
      "fuzzy_threshold",
      {the_example_gives_4_by_counts, the_example_gives_2_by_logarithms,
       the_second_order_finds_no_object_in_the_example, the_extremes_of_the_image_turn_the_sign_at_5,
       running_sums_agree_with_the_definition_on_random_histograms, degenerate_histograms_have_no_object,
       one_hot_pixel_does_not_move_the_threshold, the_threshold_is_held_between_the_floor_and_half_above_it,
       nothing_is_allocated});
}
