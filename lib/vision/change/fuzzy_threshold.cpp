// SPDX-License-Identifier: LGPL-2.1-or-later
// One reading of the paper's Eq. 4-10. Two corrections: the factor 2 / n^(1/k), which Eq. 8 and 9 both carry, is applied
// once; Eq. 8 takes the absolute value that it lacks, since terms of odd k would cancel. Whether S or 1 - S is the
// membership function does not matter: a set and its complement have the same index of fuzziness.
//
// The choice compares indices that are often exactly equal: a set of one level has index 1 with any empty level added.
// Rounding must not decide there: within the error bound of doubles it is a tie.
#include "vision/change/fuzzy_threshold.h"

#include <algorithm>
#include <cmath>
#include <compare>

namespace cerberus::vision {

namespace {

using Weights = std::array<double, 256>;  // g

// Rounding of an index of fuzziness. Derived: at most 256 terms, none above 9, each wrong by at most 8 units of 2^-53,
// make 2e-12. Guard of all four: the unit test against exact fractions.
constexpr double kIndexError = 1e-11;
// Relative rounding of an index p computed term by term, times sqrt(p). Derived: 1 - |x - b| / w is wrong by 1e-13.
constexpr double kTermError = 1e-12;
// A smaller index is 0. Derived: where two levels of equal weight make 0 rounding leaves 1e-26 at most; the smallest
// other index is 1e-19 (two levels of 2^32 and 2^32 - 1 pixels).
constexpr double kZeroIndex = 1e-22;
// Relative rounding of a sum of 256 weights and of its product with P1. Derived: 2^-53 a term.
constexpr double kSumError = 1e-13;

double sum(const Weights& g, int first, int last) {
  double total = 0;
  for (int x = first; x <= last; ++x) total += g[x];
  return total;
}

// The levels of one seed and the index of fuzziness of this set, alone and with one more level.
class SeedSet {
 public:
  // extra: a level outside the seed that is added to it.
  static constexpr int kNoExtra = -1;

  SeedSet(const Weights& weights, const FuzzyThresholdOptions& options, const FuzzyThresholdCurves& curves,
          int first, int last)
      : g_(weights),
        options_(options),
        lowest_(curves.lowest),
        highest_(curves.highest),
        first_(first),
        last_(last) {
    for (int x = first; x <= last; ++x) {
      const int k = x - first;
      s0_[k + 1] = s0_[k] + g_[x];
      s1_[k + 1] = s1_[k] + g_[x] * k;
      s2_[k + 1] = s2_[k] + g_[x] * k * k;
    }
  }

  // psi_k(A) = 2 (sum g delta^k / sum g)^(1/k), delta(x) = |mu(x) - crisp mu(x)| = (1 - |x - b| / (c - b))^2
  // / 2 (Eq. 4, 6, 7, 8 and 9; b = mean of A, c - b = distance from b to the farther extreme). Order 1 takes constant
  // time by running sums; they count the levels from the seed's first one, so that nothing cancels.
  double psi(int extra) const {
    return options_.order == 1 ? index(extra, [&](double b, double width) { return span(b, width); })
                               : psi_by_terms(extra);
  }

  // The same as a sum over all levels. Relative error: kTermError / sqrt(psi).
  double psi_by_terms(int extra = kNoExtra) const {
    return index(extra, [&](double b, double width) {
      double total = 0;
      for (int x = first_; x <= last_; ++x)
        if (g_[x] > 0) total += g_[x] * power(delta(x - first_, b, width));
      return total;
    });
  }

 private:
  struct Extent {
    int low, high;
  };

  // The levels whose distance from the mean is the width of the S-function.
  Extent extent(int extra) const {
    if (options_.extremes == Extremes::image) return {lowest_, highest_};
    if (extra == kNoExtra) return {first_, last_};
    return {std::min(first_, extra), std::max(last_, extra)};
  }

  // total(b, width) = sum of g delta^k over the seed, b counted from its first level.
  template <typename Total>
  double index(int extra, Total&& total) const {
    const double x = extra - first_, weight = extra == kNoExtra ? 0 : g_[extra];
    const double s = s0_[last_ - first_ + 1] + weight;
    if (s <= 0) return 0;
    const double b = (s1_[last_ - first_ + 1] + weight * x) / s;
    const Extent e = extent(extra);
    const double width = std::max(std::abs(b - (e.high - first_)), std::abs(b - (e.low - first_)));
    // Two levels apart have their mean at least half a level from the farther one; less is one level and rounding.
    if (width < 0.25) return 0;
    const double mean = (total(b, width) + weight * power(delta(x, b, width))) / s;
    return 2 * (options_.order == 1 ? mean : std::pow(mean, 1.0 / std::max(options_.order, 1)));
  }

  static double delta(double x, double b, double width) {
    const double d = 1 - std::abs(x - b) / width;
    return d * d / 2;
  }
  double power(double delta) const {
    return options_.order == 1 ? delta : std::pow(delta, std::max(options_.order, 1));
  }

  // sum of g delta over the seed by the running sums, levels below and above b apart.
  double span(double b, double width) const {
    const int count = last_ - first_ + 1;
    const int split = std::clamp(static_cast<int>(std::floor(b)) + 1, 0, count);
    const auto part = [&](int from, int to, double side) {  // delta = (1 + side (x - b) / width)^2 / 2
      if (to <= from) return 0.0;
      const double p = 1 - side * b / width, q = side / width;
      return (p * p * (s0_[to] - s0_[from]) + 2 * p * q * (s1_[to] - s1_[from]) +
              q * q * (s2_[to] - s2_[from])) /
             2;
    };
    return part(0, split, 1) + part(split, count, -1);
  }

  const Weights& g_;
  const FuzzyThresholdOptions& options_;
  int lowest_, highest_;  // of the histogram
  int first_, last_;      // of the seed
  // Sums of g, k g, k^2 g over the seed's first levels, k = x - first.
  std::array<double, 257> s0_{}, s1_{}, s2_{};
};

// The indices of the two seeds, their ratio, and which of two widened sets is the less fuzzy.
class Comparison {
 public:
  Comparison(const SeedSet& background, const SeedSet& object, FuzzyThresholdCurves& curves)
      : curves_(curves) {
    curves.psi_background = index(background), curves.psi_object = index(object);
    if (!(curves.psi_background > 0 && curves.psi_object > 0)) return;
    curves.alpha = curves.psi_object / curves.psi_background;  // Eq. 10
    relative_error_ =
        kTermError / std::sqrt(curves.psi_background) + kTermError / std::sqrt(curves.psi_object);
  }

  // The order of omega and beta at level x. Equal: a tie.
  std::partial_ordering operator()(int x) const {
    const double omega = curves_.omega[x], beta = curves_.beta[x];
    const double error = kIndexError * (1 + curves_.alpha) + relative_error_ * beta;
    return std::abs(omega - beta) > error ? omega <=> beta : std::partial_ordering::equivalent;
  }

 private:
  static double index(const SeedSet& seed) {
    const double psi = seed.psi_by_terms();
    return psi < kZeroIndex ? 0 : psi;
  }

  const FuzzyThresholdCurves& curves_;
  double relative_error_ = 0;  // of alpha
};

// Step 0: the level above which so few pixels lie that one hot pixel would stretch the whole scale.
int highest_kept(const Histogram& h) {
  std::uint64_t total = 0;
  for (const auto count : h) total += count;
  const std::uint64_t least = std::max<std::uint64_t>(8, total / 10000);
  std::uint64_t above = 0;
  for (int x = 255; x >= 0; --x) {
    above += h[x];
    if (above >= least) return x;
  }
  return 255;  // hardly a pixel at all: nothing to clip
}

double s_function(double x, double a, double b, double c) {  // Eq. 4
  if (x < a) return 0;
  if (x > c || c <= a) return 1;
  const double p = (x - a) / (c - a), q = (x - c) / (c - a);
  return x <= b ? 2 * p * p : 1 - 2 * q * q;
}

int choose(const FuzzyThresholdOptions& options, const FuzzyThresholdCurves& c, const Comparison& compare) {
  if (c.seed_high - c.seed_low < 2) return c.seed_low;  // no level between the seeds
  if (options.extremes == Extremes::subset) {
    for (int x = c.seed_low + 1; x < c.seed_high; ++x)
      if (compare(x) < 0) return x - 1;
  } else {
    const auto start = compare(c.seed_low + 1);
    for (int x = c.seed_low + 2; x < c.seed_high; ++x)
      if (compare(x) != start) return x - 1;
  }
  return c.seed_high - 1;
}

}  // namespace

int fuzzy_threshold(const Histogram& histogram, const FuzzyThresholdOptions& options,
                    FuzzyThresholdCurves* curves) {
  FuzzyThresholdCurves local;
  FuzzyThresholdCurves& c = curves ? *curves : local;
  c = {};

  const bool log = options.weighting == Weighting::log;
  const int top = log && options.clip ? highest_kept(histogram) : 255;
  Weights g{};
  int lowest = -1, highest = -1;
  for (int x = 0; x <= top; ++x) {
    if (!histogram[x]) continue;
    if (lowest < 0) lowest = x;
    highest = x;
    g[x] = log ? std::log1p(static_cast<double>(histogram[x])) : static_cast<double>(histogram[x]);
  }
  if (lowest < 0) return 0;
  c.lowest = c.seed_low = lowest;
  c.highest = c.seed_high = highest;
  c.middle = (lowest + highest) / 2;
  if (curves) {
    double total = 0, moment = 0;
    for (int x = lowest; x <= highest; ++x) total += g[x], moment += x * g[x];
    const double b = moment / total;
    const double reach = std::max(std::abs(b - highest), std::abs(b - lowest));
    for (int x = 0; x < 256; ++x) c.membership[x] = s_function(x, b - reach, b, b + reach);  // Eq. 4 and 6
  }
  if (highest - lowest < 3) return highest;  // no object

  // Seeds: the share P1 of each half's weight, from the ends inwards; a weight equal to the share reaches it.
  const double share = options.seed_share - kSumError;
  const double low_share = share * sum(g, lowest, c.middle),
               high_share = share * sum(g, c.middle + 1, highest);
  int j = lowest, r = highest;
  for (double weight = g[j]; j < c.middle && weight < low_share; weight += g[j]) ++j;
  for (double weight = g[r]; r > c.middle + 1 && weight < high_share; weight += g[r]) --r;
  c.seed_low = j;
  c.seed_high = r;

  const SeedSet background(g, options, c, lowest, j), object(g, options, c, r, highest);
  const Comparison compare(background, object, c);
  for (int x = j + 1; x < r; ++x) {
    c.beta[x] = c.alpha * background.psi(x);
    c.omega[x] = object.psi(x);
  }
  return choose(options, c, compare);
}

int clamp_to_noise(int threshold, double sigma) {
  const double floor = std::max(6.0, 4 * sigma);
  const int low = static_cast<int>(std::lround(std::min(floor, 255.0)));
  const int high = static_cast<int>(std::lround(std::min(1.5 * floor, 255.0)));
  return std::clamp(threshold, low, high);
}

}  // namespace cerberus::vision
