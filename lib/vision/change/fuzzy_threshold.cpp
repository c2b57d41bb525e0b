// SPDX-License-Identifier: LGPL-2.1-or-later
// One reading of the paper's Eq. 4-10. Its slips, and what is done instead: Eq. 8 and 9 both carry 2 /
// n^(1/k), which belongs once; Eq. 8 lacks the absolute value (odd k would cancel). Whether S or 1 - S is
// taken does not matter: a set and its complement have the same index of fuzziness.
#include "vision/change/fuzzy_threshold.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

// The weighted histogram g with running sums, so that the index of any span of levels takes constant time
// (order 1).
struct Weights {
  std::array<double, 256> g{};
  std::array<double, 257> s0{}, s1{}, s2{};  // sums of g, x g, x^2 g over the levels below the index

  void accumulate() {
    for (int x = 0; x < 256; ++x) {
      s0[x + 1] = s0[x] + g[x];
      s1[x + 1] = s1[x] + g[x] * x;
      s2[x + 1] = s2[x] + g[x] * x * x;
    }
  }
  double sum(int first, int last) const { return last < first ? 0 : s0[last + 1] - s0[first]; }
};

// The levels first..last plus one single level (-1: none).
struct Subset {
  int first, last, extra;
};

class Indices {
 public:
  Indices(const Weights& weights, const FuzzyThresholdOptions& options, int lowest, int highest)
      : w_(weights), options_(options), lowest_(lowest), highest_(highest) {}

  // psi_k(A) = 2 (sum g delta^k / sum g)^(1/k), delta(x) = |mu(x) - crisp mu(x)| = (1 - |x - b| / (c - b))^2
  // / 2 (Eq. 4, 6, 7, 8 and 9; b = mean of A, c - b = distance from b to the farther extreme).
  double psi(const Subset& set) const {
    const double extra = set.extra >= 0 ? w_.g[set.extra] : 0;
    const double sum = w_.sum(set.first, set.last) + extra;
    if (sum <= 0) return 0;
    const double b = (w_.s1[set.last + 1] - w_.s1[set.first] + extra * set.extra) / sum;
    int low = lowest_, high = highest_;
    if (options_.extremes == Extremes::subset) {
      low = set.extra >= 0 ? std::min(set.first, set.extra) : set.first;
      high = std::max(set.last, set.extra);
    }
    const double width = std::max(std::abs(b - high), std::abs(b - low));
    // Two levels apart have their mean at least half a level from the farther one; less is one level and rounding.
    if (width < 0.25) return 0;
    if (options_.order == 1) {
      double total = span(set.first, set.last, b, width);
      if (set.extra >= 0) total += extra * delta(set.extra, b, width);
      return 2 * total / sum;
    }
    const double k = std::max(options_.order, 1);
    double total = set.extra >= 0 ? extra * std::pow(delta(set.extra, b, width), k) : 0;
    for (int x = set.first; x <= set.last; ++x)
      if (w_.g[x] > 0) total += w_.g[x] * std::pow(delta(x, b, width), k);
    return 2 * std::pow(total / sum, 1 / k);
  }

 private:
  static double delta(int x, double b, double width) {
    const double d = 1 - std::abs(x - b) / width;
    return d * d / 2;
  }

  // sum of g delta over first..last by the running sums, levels below and above b apart.
  double span(int first, int last, double b, double width) const {
    const int split = std::clamp(static_cast<int>(std::floor(b)), first - 1, last);
    const auto part = [&](int from, int to, double side) {  // delta = (1 + side (x - b) / width)^2 / 2
      if (to < from) return 0.0;
      const double p = 1 - side * b / width, q = side / width;
      return (p * p * (w_.s0[to + 1] - w_.s0[from]) + 2 * p * q * (w_.s1[to + 1] - w_.s1[from]) +
              q * q * (w_.s2[to + 1] - w_.s2[from])) /
             2;
    };
    return part(first, split, 1) + part(split + 1, last, -1);
  }

  const Weights& w_;
  const FuzzyThresholdOptions& options_;
  int lowest_, highest_;
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

int choose(const FuzzyThresholdOptions& options, const FuzzyThresholdCurves& c) {
  if (c.seed_high - c.seed_low < 2) return c.seed_low;  // no level between the seeds
  if (options.extremes == Extremes::subset) {
    for (int x = c.seed_low + 1; x < c.seed_high; ++x)
      if (c.omega[x] < c.beta[x]) return x - 1;
  } else {
    const auto sign = [&](int x) { return (c.omega[x] > c.beta[x]) - (c.omega[x] < c.beta[x]); };
    const int start = sign(c.seed_low + 1);
    for (int x = c.seed_low + 2; x < c.seed_high; ++x)
      if (sign(x) != start) return x - 1;
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
  Weights w;
  int lowest = -1, highest = -1;
  for (int x = 0; x <= top; ++x) {
    if (!histogram[x]) continue;
    if (lowest < 0) lowest = x;
    highest = x;
    w.g[x] = log ? std::log1p(static_cast<double>(histogram[x])) : static_cast<double>(histogram[x]);
  }
  if (lowest < 0) return 0;
  w.accumulate();
  c.lowest = c.seed_low = lowest;
  c.highest = c.seed_high = highest;
  c.middle = (lowest + highest) / 2;
  if (curves) {
    const double b = (w.s1[256]) / w.s0[256];
    const double reach = std::max(std::abs(b - highest), std::abs(b - lowest));
    for (int x = 0; x < 256; ++x) c.membership[x] = s_function(x, b - reach, b, b + reach);  // Eq. 4 and 6
  }
  if (highest - lowest < 3) return highest;  // no object

  // Seeds: the share P1 of each half's weight, from the ends inwards.
  const double low_share = options.seed_share * w.sum(lowest, c.middle);
  const double high_share = options.seed_share * w.sum(c.middle + 1, highest);
  int j = lowest, r = highest;
  while (j < c.middle && w.sum(lowest, j) < low_share) ++j;
  while (r > c.middle + 1 && w.sum(r, highest) < high_share) --r;
  c.seed_low = j;
  c.seed_high = r;

  const Indices indices(w, options, lowest, highest);
  c.psi_background = indices.psi({lowest, j, -1});
  c.psi_object = indices.psi({r, highest, -1});
  if (c.psi_background > 0 && c.psi_object > 0) c.alpha = c.psi_object / c.psi_background;  // Eq. 10
  for (int x = j + 1; x < r; ++x) {
    c.beta[x] = c.alpha * indices.psi({lowest, j, x});
    c.omega[x] = indices.psi({r, highest, x});
  }
  return choose(options, c);
}

int clamp_to_noise(int threshold, double sigma) {
  const double floor = std::max(6.0, 4 * sigma);
  const int low = static_cast<int>(std::lround(std::min(floor, 255.0)));
  const int high = static_cast<int>(std::lround(std::min(1.5 * floor, 255.0)));
  return std::clamp(threshold, low, high);
}

}  // namespace cerberus::vision
