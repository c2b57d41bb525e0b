// SPDX-License-Identifier: LGPL-2.1-or-later
// The threshold by indices of fuzziness against an example computed by hand (fractions), against the definition
// written out as sums, and against exact fractions.
#include "vision/change/fuzzy_threshold.h"

#include <check.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <numeric>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

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

// The definition in exact fractions, linear weighting and order 1. Levels up to 47 and at most 40 pixels keep every
// number below 2^63.
struct Exact {
  std::int64_t n, d;  // n / d >= 0

  std::strong_ordering operator<=>(Exact o) const {  // by continued fractions: no product, no overflow
    for (auto [a, b, c, e] = std::array{n, d, o.n, o.d};;) {
      if (a / b != c / e) return a / b <=> c / e;
      a %= b, c %= e;
      if (a == 0 || c == 0) return a <=> c;
      // a/b <=> c/e is the reverse of b/a <=> e/c.
      std::tie(a, b, c, e) = std::tuple(e, c, b, a);
    }
  }
  Exact operator*(Exact o) const {
    const auto g = std::gcd(n, o.d), h = std::gcd(o.n, d);
    return {n / g * (o.n / h), d / h * (o.d / g)};
  }
};

Exact exact_psi(const Histogram& h, const std::vector<int>& levels, Extremes extremes, int x0, int x1) {
  std::int64_t s = 0, t = 0, total = 0;
  for (const int x : levels) s += h[x], t += x * std::int64_t{h[x]};
  const auto [lo, hi] = extremes == Extremes::image
                            ? std::pair(x0, x1)
                            : std::pair(*std::ranges::min_element(levels), *std::ranges::max_element(levels));
  const auto width = std::max(std::abs(hi * s - t), std::abs(lo * s - t));
  if (width == 0) return {0, 1};
  for (const int x : levels) {
    const auto d = width - std::abs(x * s - t);
    total += h[x] * d * d;
  }
  return {total, s * width * width};
}

int exact_threshold(const Histogram& h, Extremes extremes) {
  int x0 = 0, x1 = 255;
  while (!h[x0]) ++x0;
  while (!h[x1]) --x1;
  if (x1 - x0 < 3) return x1;
  const int m = (x0 + x1) / 2;
  const auto count = [&](int from, int to) {
    return std::accumulate(h.begin() + from, h.begin() + to + 1, std::int64_t{0});
  };
  int j = x0, r = x1;
  while (10000 * count(x0, j) < 3964 * count(x0, m)) ++j;
  while (10000 * count(r, x1) < 3964 * count(m + 1, x1)) --r;
  if (r - j < 2) return j;
  std::vector<int> background, object;
  for (int x = x0; x <= j; ++x) background.push_back(x);
  for (int x = r; x <= x1; ++x) object.push_back(x);
  const auto psi = [&](std::vector<int> levels, int extra) {
    if (extra >= 0) levels.push_back(extra);
    return exact_psi(h, levels, extremes, x0, x1);
  };
  Exact b = psi(background, -1), w = psi(object, -1);
  if (b.n == 0 || w.n == 0) b = w = {1, 1};
  const auto compare = [&](int x) { return psi(object, x) * b <=> psi(background, x) * w; };
  for (int x = j + 1; x < r; ++x)
    if (extremes == Extremes::subset ? compare(x) < 0 : compare(x) != compare(j + 1)) return x - 1;
  return r - 1;
}

// Histograms of any counts and their thresholds (subset, image), computed with Python's fractions from
// Eq. 4-10; of the first, doubles without an error bound made 91. Of {9, 14, 74, 126, 132, 206, 230} with {1,
// 1755811482, 28777, 60311, 18214, 46037, 41325} pixels, more than any picture has, two indices differ by less than
// rounding: a tie.
struct Known {
  std::vector<std::pair<int, std::uint32_t>> counts;
  int subset, image;
};
// clang-format off
const Known kKnown[] = {
    {{{91, 50568u}, {117, 54970u}, {120, 11293u}, {173, 21866u}}, 119, 116},
    {{{22, 48551u}, {45, 825625153u}, {199, 2093375978u}, {205, 11166u}}, 71, 198},
    {{{32, 67740u}, {55, 1659443156u}, {75, 4911u}, {132, 1u}, {208, 5000u}, {254, 1u}}, 74, 74},
    {{{49, 46753u}, {76, 50000u}, {112, 1u}, {146, 2509834370u}, {151, 1u}, {216, 1u}, {253, 50000u}}, 252, 150},
    {{{89, 3583360804u}, {103, 1u}, {118, 2444376602u}, {194, 1u}, {208, 2422349932u}}, 102, 102},
    {{{1, 20000u}, {32, 20141u}, {48, 50000u}, {153, 1u}, {174, 24862u}, {184, 1u}}, 32, 47},
    {{{11, 1u}, {46, 543106621u}, {55, 1u}, {88, 1u}, {226, 4165554686u}, {228, 1u}, {233, 50000u}, {254, 15854u}}, 197, 54},
    {{{40, 20000u}, {100, 1u}, {102, 1u}, {105, 20000u}, {154, 50000u}, {182, 2632958563u}}, 181, 99},
    {{{137, 1u}, {149, 50000u}, {188, 32755u}, {198, 1u}, {210, 50000u}, {214, 5000u}, {234, 32053u}, {250, 47473u}}, 233, 187},
    {{{23, 4265258704u}, {135, 17932u}, {144, 1987242602u}}, 134, 134},
    {{{18, 48006u}, {33, 5000u}, {51, 1u}, {70, 1u}, {167, 5000u}, {178, 1u}, {199, 5000u}}, 32, 32},
    {{{29, 1u}, {56, 2149210466u}, {86, 42840u}, {115, 10876u}, {147, 261335613u}, {151, 5000u}, {172, 29178u}}, 85, 85},
    {{{16, 1250690027u}, {65, 4061414997u}, {111, 20000u}, {158, 48045u}, {250, 69011u}}, 110, 110},
    {{{7, 49164u}, {177, 50000u}, {217, 10448u}}, 7, 176},
    {{{52, 5000u}, {72, 1u}, {154, 63386u}, {184, 41043u}, {188, 1u}, {219, 50000u}, {244, 62477u}}, 52, 71},
    {{{147, 3363906036u}, {148, 20000u}, {185, 1u}, {255, 1u}}, 147, 148},
    {{{5, 50000u}, {8, 1u}, {47, 5000u}, {74, 68589u}, {101, 50000u}, {104, 2018765079u}, {108, 157163730u}, {111, 5000u}}, 5, 7},
    {{{14, 53714u}, {57, 3518302464u}, {74, 1u}, {103, 1u}, {129, 1u}, {161, 3305863210u}}, 160, 73},
    {{{11, 20000u}, {79, 4255744302u}, {82, 5000u}, {96, 53222u}, {158, 237078819u}, {222, 1u}, {237, 3543253013u}, {240, 47812u}}, 95, 81},
    {{{8, 44305u}, {36, 50000u}, {121, 58266u}, {172, 31450u}, {197, 1u}, {204, 5000u}, {249, 1u}}, 37, 120},
    {{{52, 1599981434u}, {127, 10667u}, {141, 234498193u}}, 126, 126},
    {{{29, 61329u}, {60, 68573u}, {93, 496247389u}, {150, 50000u}, {196, 5000u}, {229, 2792128418u}, {244, 1u}, {251, 41023u}}, 149, 149},
    {{{34, 50000u}, {140, 2914232391u}, {180, 50000u}, {224, 2370466140u}, {244, 37359u}}, 34, 139},
    {{{15, 1073236678u}, {93, 1u}, {121, 50000u}, {251, 1u}}, 92, 92},
    {{{51, 1822907012u}, {53, 1u}, {56, 2878299953u}, {64, 4097015457u}, {188, 405712580u}, {199, 17062u}, {227, 9727u}}, 57, 63},
    {{{6, 943263643u}, {108, 36192u}, {186, 5000u}, {213, 5000u}}, 107, 107},
    {{{15, 2695910820u}, {26, 279192842u}, {29, 19438u}, {42, 50000u}, {122, 31618u}, {161, 484248363u}, {163, 1u}, {181, 5000u}}, 15, 25},
    {{{8, 5000u}, {13, 39440u}, {72, 5000u}, {164, 46641u}, {180, 18320u}}, 152, 71},
    {{{7, 50000u}, {147, 1u}, {163, 59936u}, {177, 50000u}, {186, 39613u}}, 7, 146},
    {{{7, 61196u}, {171, 1u}, {192, 43720u}}, 170, 170},
    {{{5, 5000u}, {101, 1u}, {133, 1798278923u}, {207, 20000u}, {212, 686377201u}, {217, 20000u}, {251, 3954156340u}}, 132, 100},
    {{{40, 2958816585u}, {58, 5000u}, {88, 43678u}, {117, 4086913546u}, {118, 47011u}, {150, 5000u}}, 40, 57},
    {{{28, 3173932790u}, {57, 1u}, {68, 1291271596u}, {70, 20000u}, {115, 1u}, {184, 1u}, {207, 7950u}, {239, 3798969297u}}, 238, 56},
    {{{15, 1u}, {41, 20000u}, {53, 4234u}, {93, 10386u}, {141, 5000u}, {218, 1u}}, 52, 52},
    {{{70, 1u}, {116, 1u}, {222, 1u}, {237, 50000u}, {250, 20000u}}, 70, 115},
    {{{70, 1u}, {126, 1u}, {147, 1u}, {157, 1398422962u}, {200, 1u}, {252, 4281u}}, 199, 199},
    {{{21, 50000u}, {45, 1238497058u}, {52, 1u}, {81, 1u}, {196, 1u}, {217, 50000u}, {247, 20000u}}, 204, 51},
    {{{69, 1u}, {145, 1u}, {214, 1u}, {221, 1u}}, 220, 213},
    {{{66, 2841466656u}, {137, 2221894605u}, {175, 20000u}, {200, 2060u}, {242, 5503u}}, 66, 136},
};
// clang-format on

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

START_TEST(ties_are_exact_in_thousands_of_sparse_histograms) {
  std::mt19937 random(11);
  for (int round = 0; round < 20000; ++round) {
    Histogram h{};
    const int levels = 2 + static_cast<int>(random() % 6), top = 4 + static_cast<int>(random() % 44);
    for (int k = 0; k < levels; ++k) h[random() % top] += 1 + random() % (round % 2 ? 2 : 6);
    for (const auto extremes : {Extremes::subset, Extremes::image})
      ck_assert_msg(fuzzy_threshold(h, options(Weighting::linear, extremes)) == exact_threshold(h, extremes),
                    "round %d: %d instead of %d", round,
                    fuzzy_threshold(h, options(Weighting::linear, extremes)), exact_threshold(h, extremes));
  }
}
END_TEST

START_TEST(ties_are_exact_with_large_counts) {
  for (const auto& known : kKnown) {
    Histogram h{};
    for (const auto& [level, count] : known.counts) h[level] = count;
    ck_assert_int_eq(fuzzy_threshold(h, options(Weighting::linear, Extremes::subset)), known.subset);
    ck_assert_int_eq(fuzzy_threshold(h, options(Weighting::linear, Extremes::image)), known.image);
  }
}
END_TEST

// A set of one level has index 0, which makes alpha 1, and index 1 with any empty level added. So the levels between the
// seeds 91 and 173 are ties up to 116.
START_TEST(a_tie_is_background_in_every_weighting_and_order) {
  Histogram h{};
  h[91] = 50568, h[117] = 54970, h[120] = 11293, h[173] = 21866;
  for (const auto weighting : {Weighting::linear, Weighting::log})
    for (const int order : {1, 2, 3}) {
      FuzzyThresholdOptions o = options(weighting, Extremes::subset, order);
      o.seed_share = .1;
      FuzzyThresholdCurves c;
      ck_assert_int_ge(fuzzy_threshold(h, o, &c), 116);
      ck_assert_int_eq(c.seed_low, 91);
      ck_assert_int_eq(c.seed_high, 173);
    }
  // Two levels of equal weight have index 0, not what rounding leaves of it: alpha is 1.
  for (const auto weighting : {Weighting::linear, Weighting::log}) {
    Histogram pair{};
    pair[3] = pair[8] = 77, pair[60] = 1000, pair[61] = 900, pair[90] = 5;
    FuzzyThresholdOptions o = options(weighting, Extremes::subset);
    o.seed_share = .9;
    FuzzyThresholdCurves c;
    fuzzy_threshold(pair, o, &c);
    ck_assert_int_eq(c.seed_low, 8);
    ck_assert_double_eq(c.psi_background, 0);
    ck_assert_double_eq(c.alpha, 1);
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
       running_sums_agree_with_the_definition_on_random_histograms,
       ties_are_exact_in_thousands_of_sparse_histograms, ties_are_exact_with_large_counts,
       a_tie_is_background_in_every_weighting_and_order, degenerate_histograms_have_no_object,
       one_hot_pixel_does_not_move_the_threshold, the_threshold_is_held_between_the_floor_and_half_above_it,
       nothing_is_allocated});
}
