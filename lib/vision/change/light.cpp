// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/change/light.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "vision/image/median.h"
#include "vision/image/rounding.h"

namespace cerberus::vision {

namespace {

constexpr int kBand = LightSamples::kBandRows *
                      LightSamples::kRowStep;  // rows; flicker at 100 Hz has a period of 70 rows and more
constexpr int kMaximumBands = 512;             // pictures of more bands are not searched for them

// Origin unknown: kept from the first version. Guard of all: unit-light, and flicker and bands in unit-foreground_mask.
constexpr struct Parameters {
  // The picture as a whole: a line through the median differences of brightness classes.
  int least_class = 100;          // 1/n of the samples: a smaller class does not count
  double clipped = 4;             // grey levels: a class at or below was possibly clipped
  int rounds = 6;                 // of reweighting
  double ridge = 10 * 10;         // grey levels squared: strength of the prior that black stays black
  int agrees = 8;                 // grey levels: a sample so close to the line agrees with it
  double dark = 48, light = 208;  // grey levels between which a change counts
  double least_global = 0.7;      // grey levels: a change that is smaller there is not compensated
  double least_gain = 0.25, most_gain = 4.0;  // of a change of light
  // Bands of rows.
  int least_of_third = 8;   // samples of a third of a band that counts
  int least_samples = 12;   // samples of a band that counts
  double least_band = 1.0;  // grey levels: weaker bands are not compensated
} kParameters;

// Returns whether two thirds of a band are mostly brighter, or mostly darker: a band of light covers the whole row, an
// object rarely does. Without such thirds, no median can be as far from 0 as kParameters.least_band.
bool has_one_direction(const LightSums& sums) {
  int thirds = 0, up = 0, down = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (sums.number[i] < kParameters.least_of_third) continue;  // white
    ++thirds;
    up += 2 * sums.brighter[i] > sums.number[i];
    down += 2 * sums.darker[i] > sums.number[i];
  }
  return thirds > 0 && std::max(up, down) >= std::min(thirds, 2);
}

int number_of(const LightSums& sums) {
  return sums.number[0] + sums.number[1] + sums.number[2];
}

}  // namespace

void LightChange::clear() {
  none_ = true;
  gain_ = 1;
  offset_ = 0;
  agreement_ = 1;
  std::fill(rows_.begin(), rows_.end(), RowLight{});
  std::fill(doubt_.begin(), doubt_.end(), std::uint8_t{0});
}

void LightChange::relight(const std::uint8_t* reference, const std::uint8_t* present, int y, int count,
                          std::uint8_t* out) const {
  relight_row_with_white(reference, present, row(y), count, out);
  const int doubt = y < static_cast<int>(doubt_.size()) ? doubt_[y] : 0;
  if (!doubt) return;
  for (int x = 0; x < count; ++x) {
    const int reach = (out[x] * doubt + 255) >> 8;
    out[x] = static_cast<std::uint8_t>(
        std::clamp<int>(present[x], std::max(out[x] - reach, 0), std::min(out[x] + reach, 255)));
  }
}

RowLight LightChange::light_of(int row) const {
  return rows_[static_cast<std::size_t>(LightSamples::picture_row(row))];
}

void LightChange::estimate(const LightSamples& samples, bool still) {
  rows_.resize(static_cast<std::size_t>(samples.height()));
  doubt_.resize(rows_.size());
  clear();
  if (rows_.empty()) return;
  const bool line = estimate_global(samples);
  const bool bands = estimate_bands(samples);
  if (still && line && bands) {
    // If bright and dark areas lie in different bands, the global line fits the bands as an effect of brightness; the
    // bands must then be estimated first. Both orders are tried, and the one with the smaller residual is kept.
    const double remains = misfit(samples), agreement = agreement_;
    std::array<RowLight, kMaximumBands * kBand> line_first;
    std::ranges::copy(rows_, line_first.begin());
    std::ranges::fill(rows_, RowLight{});
    estimate_bands(samples);
    estimate_global(samples);
    estimate_bands(samples);
    if (misfit(samples) > remains) {
      std::copy_n(line_first.begin(), rows_.size(), rows_.begin());
      agreement_ = agreement;
    }
  }
  double gain = 0, offset = 0;
  for (const RowLight& r : rows_) gain += r.gain, offset += r.offset;
  gain_ = gain / (256.0 * samples.height());
  offset_ = offset / (256.0 * samples.height());
  none_ = std::ranges::all_of(rows_, [](const RowLight& r) { return r == RowLight{}; });
}

// Counts samples by the brightness of the reference under the current estimate (16 levels a class) and by the
// difference of the present picture.
LightChange::Counts LightChange::count_differences(const LightSamples& samples) const {
  Counts counts{};
  for (int row = 0; row < samples.rows(); ++row)
    samples.for_each(
        row, light_of(row), [&](auto*, const std::uint8_t* now, const std::uint8_t* value, int n) {
          std::array<std::uint16_t, kSampleLanes> cell;  // computed for the whole array, so that vectors can
          for (int i = 0; i < kSampleLanes; ++i)
            cell[i] = static_cast<std::uint16_t>((now[i] >> 4) * kLevels + kReach +
                                                 std::clamp(value[i] - now[i], -kReach, kReach));
          for (int i = 0; i < n; ++i) counts[cell[i]] += 1 | static_cast<std::uint64_t>(now[i] & 15) << 32;
        });
  return counts;
}

// Estimates the global change of light. Returns true if there is one.
bool LightChange::estimate_global(const LightSamples& samples) {
  const auto counts = count_differences(samples);
  const auto of_class = [&](int k) {
    return std::span(counts).subspan(static_cast<std::size_t>(k) * kLevels, kLevels);
  };
  std::array<int, kClasses> number{};
  std::array<std::int64_t, kClasses> sum{};
  for (int k = 0; k < kClasses; ++k) {
    std::uint64_t all = 0;
    for (const std::uint64_t count : of_class(k)) all += count;
    number[k] = static_cast<int>(all & 0xffffffffu);
    sum[k] = std::int64_t{16} * k * number[k] + static_cast<std::int64_t>(all >> 32);
  }
  int total = 0;
  for (const int n : number) total += n;
  const Parameters& p = kParameters;
  if (total == 0) return false;

  struct Entry {
    double a, e, weight;
  };
  std::array<Entry, kClasses> points;
  int used = 0;
  for (int k = 0; k < kClasses; ++k) {
    if (number[k] * p.least_class < total) continue;
    const double a = static_cast<double>(sum[k]) / number[k],
                 e = median_of_levels(of_class(k), number[k], -kReach);
    if (a + e > kNearWhite || a + e < p.clipped || a > kNearWhite)
      continue;  // clipped: no information about the gain
    points[used++] = {a, e, static_cast<double>(number[k])};
  }
  // e = offset + slope (a - mean), by least squares whose weights fall with the distance from the line
  // (Cauchy, scale one grey level). A narrow range of brightness determines only a gain, which is what
  // exposure and lamps change. A picture that is clipped everywhere determines nothing: no change is assumed.
  double slope = 0, offset = 0, mean = 0;
  std::array<double, kClasses> w;
  for (int i = 0; i < used; ++i) w[i] = points[i].weight;
  for (int round = 0; round < p.rounds && used; ++round) {
    double sw = 0, sa = 0, se = 0, saa = 0, sae = 0;
    for (int i = 0; i < used; ++i) sw += w[i], sa += w[i] * points[i].a, se += w[i] * points[i].e;
    mean = sa / sw;
    offset = se / sw;
    for (int i = 0; i < used; ++i) {
      const double da = points[i].a - mean;
      saa += w[i] * da * da;
      sae += w[i] * da * (points[i].e - offset);
    }
    // A prior that black stays black to within the noise.
    slope = (sae + p.ridge * sw * offset / std::max(mean, p.clipped)) / (saa + p.ridge * sw);
    for (int i = 0; i < used; ++i) {
      const double r = points[i].e - offset - slope * (points[i].a - mean);
      w[i] = points[i].weight / (1 + r * r);
    }
  }
  const double at_zero = offset - slope * mean;
  int agree = 0;
  for (int k = 0; k < kClasses; ++k) {
    if (!number[k]) continue;
    const double a = static_cast<double>(sum[k]) / number[k];
    const int e = static_cast<int>(std::lround(std::clamp(a + at_zero + slope * a, 0.0, 255.0) - a));
    for (int d = std::max(e - p.agrees, -kReach); d <= std::min(e + p.agrees, kReach); ++d)
      agree += static_cast<int>(of_class(k)[static_cast<std::size_t>(d + kReach)]);
  }
  agreement_ = static_cast<double>(agree) / total;
  // A change that is small from dark grey to light grey is not compensated.
  if (std::max(std::abs(at_zero + p.dark * slope), std::abs(at_zero + p.light * slope)) < p.least_global)
    return false;
  const double gain = std::clamp(1 + slope, p.least_gain, p.most_gain);
  const auto relit = [&](RowLight row) {
    return RowLight{round_to_int(row.gain * gain), round_to_int(row.offset * gain + 256 * at_zero)};
  };
  RowLight before, after = relit(before);  // reused, because most rows have the same light
  for (RowLight& row : rows_) {
    if (row != before) before = row, after = relit(row);
    row = after;
  }
  return true;
}

// Returns the mean residual difference, grey levels a sample; large differences, as of objects, are limited.
double LightChange::misfit(const LightSamples& samples) const {
  std::int64_t sum = 0, number = 0;
  for (int band = 0; band < samples.bands(); ++band) {
    const LightSums sums = samples.sums_of_band(band, rows_);
    sum += sums.misfit;
    number += number_of(sums);
  }
  return number ? static_cast<double>(sum) / number : 0;
}

// The median of the gains of a band's samples, less 1, at most SampleGains::kReach. Dark samples weigh little.
double LightChange::excess_of_band(const LightSamples& samples, int band) const {
  std::array<std::uint32_t, 2 * SampleGains::kReach + 1> counts{};
  std::int64_t weights = 0;
  for (int row = samples.first_row(band); row < samples.first_row(band + 1); ++row)
    samples.for_each(row, light_of(row), [&](auto* level, auto* now, auto* value, int n) {
      SampleGains gains;
      find_gains(level, now, value, gains);
      for (int i = 0; i < n; ++i) {
        counts[gains.lower[i]] += gains.weight[i];
        counts[gains.higher[i]] += gains.weight[i];
        weights += 2 * gains.weight[i];
      }
    });
  return median_of_levels(counts, weights, -SampleGains::kReach) / 256;
}

// Estimates the bands. Returns true if there are any.
bool LightChange::estimate_bands(const LightSamples& samples) {
  const int bands = samples.bands();
  if (bands < 2 || bands > kMaximumBands) return false;
  std::array<double, kMaximumBands> excess;  // gain of the band, minus 1
  std::bitset<kMaximumBands> known;
  double strongest = 0;
  for (int band = 0; band < bands; ++band) {
    const LightSums sums = samples.sums_of_band(band, rows_);
    const int number = number_of(sums);
    known[band] = number >= kParameters.least_samples && sums.level > 0 &&
                  std::ranges::max(sums.number) >= kParameters.least_of_third;
    if (!known[band]) continue;
    excess[band] = has_one_direction(sums) ? excess_of_band(samples, band) : 0;
    strongest = std::max(strongest, std::abs(excess[band]) * sums.level / number);
  }
  if (strongest < kParameters.least_band) return false;
  // A band without usable samples takes the light of its neighbours, within the range of the measured bands.
  double least = 1, most = -1;
  for (int band = 0; band < bands; ++band)
    if (known[band]) least = std::min(least, excess[band]), most = std::max(most, excess[band]);
  for (int band = 0; band < bands; ++band) {
    if (known[band]) continue;
    int low = band, high = band;
    while (low >= 0 && !known[low]) --low;
    while (high < bands && !known[high]) ++high;
    if (low < 0) low = high;
    if (high == bands) high = low;
    excess[band] =
        excess[low] + (high > low ? (excess[high] - excess[low]) * (band - low) / (high - low) : 0);
  }
  for (int y = 0; y < static_cast<int>(rows_.size());
       ++y) {  // linear between the middles of bands, and beyond the outermost
    const double position = (y + 0.5) / kBand - 0.5;
    const int low = std::clamp(static_cast<int>(position), 0, bands - 2);
    const double k = 1 + excess[low] + (position - low) * (excess[low + 1] - excess[low]);
    rows_[y].gain = round_to_int(rows_[y].gain * k);
    rows_[y].offset = round_to_int(rows_[y].offset * k);
    const double doubt = known[y / kBand] ? 0 : std::max(most - (k - 1), k - 1 - least);
    doubt_[y] =
        std::max(doubt_[y], static_cast<std::uint8_t>(std::clamp(std::lround(256 * doubt), 0L, 255L)));
  }
  return true;
}

}  // namespace cerberus::vision
