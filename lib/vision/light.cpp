// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "vision/median.h"

namespace cerberus::vision {

namespace {

constexpr int kBand = 8;  // rows; flicker at 100 Hz has a period of 70 rows and more
constexpr int kColumnStep = 8, kRowStep = 2;
constexpr int kBandReach = 16;        // grey levels a band may differ by
constexpr double kLeastBand = 1.0;    // grey levels: weaker bands are left alone
constexpr double kLeastGlobal = 0.7;  // the same for the picture as a whole

RowSpan span_of(std::span<const RowSpan> spans, int y, int width) {
  return spans.empty() ? RowSpan{0, width} : spans[static_cast<std::size_t>(y)];
}

}  // namespace

void LightChange::clear() {
  none_ = true;
  gain_ = 1;
  offset_ = 0;
  agreement_ = 1;
  std::fill(rows_.begin(), rows_.end(), RowLight{});
}

void LightChange::estimate(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  rows_.resize(static_cast<std::size_t>(present.height));
  clear();
  if (present.empty()) return;
  estimate_global(reference, present, spans);
  estimate_bands(reference, present, spans);
  none_ = std::ranges::all_of(rows_, [](const RowLight& r) { return r == RowLight{}; });
}

void LightChange::estimate_global(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  // 32 bits: a sixteenth of 3840 x 2160 pixels may all be alike.
  std::array<std::array<std::uint32_t, kLevels>, kClasses> counts{};
  std::array<std::uint32_t, 256> seen{};  // samples by level of the reference
  for (int y = 0; y < present.height; y += kRowStep) {
    const RowSpan s = span_of(spans, y, present.width);
    const std::uint8_t *a = reference.row(y), *b = present.row(y);
    for (int x = s.begin + (y / kRowStep) % kColumnStep; x < s.end; x += kColumnStep) {
      ++counts[a[x] >> 4][std::clamp(b[x] - a[x], -kReach, kReach) + kReach];
      ++seen[a[x]];
    }
  }
  std::array<int, kClasses> number{};
  std::array<std::int64_t, kClasses> sum{};
  for (int level = 0; level < 256; ++level) {
    number[level >> 4] += static_cast<int>(seen[level]);
    sum[level >> 4] += std::int64_t{level} * seen[level];
  }
  int total = 0;
  for (const int n : number) total += n;
  if (total < 64) return;

  struct Entry {
    double a, e, weight;
  };
  std::array<Entry, kClasses> points;
  int used = 0;
  for (int k = 0; k < kClasses; ++k) {
    if (number[k] * 100 < total) continue;
    const double a = static_cast<double>(sum[k]) / number[k], e = median_of_levels(counts[k], number[k], -kReach);
    if (a + e > 250 || a + e < 4 || a > 250) continue;  // clipped: says nothing about gain
    points[used++] = {a, e, static_cast<double>(number[k])};
  }
  if (!used) return;
  // e = offset + slope (a - mean), by least squares whose weights fall with the distance from the line
  // (Cauchy, scale one grey level). With a narrow range of brightness only the offset can be told.
  double slope = 0, offset = 0, mean = 0;
  std::array<double, kClasses> w;
  for (int i = 0; i < used; ++i) w[i] = points[i].weight;
  for (int round = 0; round < 6; ++round) {
    double sw = 0, sa = 0, se = 0, saa = 0, sae = 0;
    for (int i = 0; i < used; ++i) sw += w[i], sa += w[i] * points[i].a, se += w[i] * points[i].e;
    mean = sa / sw;
    offset = se / sw;
    for (int i = 0; i < used; ++i) {
      const double da = points[i].a - mean;
      saa += w[i] * da * da;
      sae += w[i] * da * (points[i].e - offset);
    }
    slope = sae /
            (saa + 100 * sw);  // as if the gain were known to be 1 to within the noise: a ridge of 10 levels
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
    for (int d = std::max(e - 8, -kReach); d <= std::min(e + 8, kReach); ++d) agree += counts[k][d + kReach];
  }
  agreement_ = static_cast<double>(agree) / total;
  // What is hardly visible between dark grey and light grey is not worth a correction.
  if (std::max(std::abs(at_zero + 48 * slope), std::abs(at_zero + 208 * slope)) < kLeastGlobal) return;
  gain_ = std::clamp(1 + slope, 0.25, 4.0);
  offset_ = at_zero;
  const RowLight light{static_cast<std::int32_t>(std::lround(256 * gain_)),
                       static_cast<std::int32_t>(std::lround(256 * offset_))};
  std::fill(rows_.begin(), rows_.end(), light);
}

// Calls each(third, value of the reference under the light so far, present value) for the samples of a band of rows.
template <typename Each>
void LightChange::sample_band(GrayView reference, GrayView present, std::span<const RowSpan> spans, int band,
                              Each&& each) const {
  for (int y = band * kBand; y < std::min((band + 1) * kBand, present.height); y += kRowStep) {
    const RowSpan s = span_of(spans, y, present.width);
    const std::uint8_t *a = reference.row(y), *b = present.row(y);
    const RowLight light = rows_[y];
    const bool lit = !(light == RowLight{});
    for (int third = 0; third < 3; ++third) {
      const int end = std::min(s.end, (third + 1) * present.width / 3);
      for (int x = std::max(s.begin, third * present.width / 3) + (y / kRowStep) % kColumnStep; x < end;
           x += kColumnStep)
        each(third, lit ? std::clamp((a[x] * light.gain + light.offset + 128) >> 8, 0, 255) : a[x], b[x]);
    }
  }
}

// Whether more than half of what two thirds of a band show is at least one level brighter, or darker: no median is
// as far from 0 as kLeastBand otherwise.
bool LightChange::may_differ(GrayView reference, GrayView present, std::span<const RowSpan> spans,
                             int band) const {
  std::array<int, 3> number{}, brighter{}, darker{};
  sample_band(reference, present, spans, band, [&](int third, int now, int value) {
    ++number[third];
    brighter[third] += value > now;
    darker[third] += value < now;
  });
  int thirds = 0;
  for (int i = 0; i < 3; ++i) thirds += 2 * std::max(brighter[i], darker[i]) > number[i];
  return thirds >= 2;
}

void LightChange::estimate_bands(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  const int bands = (present.height + kBand - 1) / kBand;
  constexpr int kMaximumBands = 512;
  if (bands < 4 || bands > kMaximumBands) return;
  int first = 0;
  while (first < bands && !may_differ(reference, present, spans, first)) ++first;
  if (first == bands) return;
  std::array<double, kMaximumBands> excess;  // gain of the band, minus 1
  double strongest = 0;
  for (int band = 0; band < bands; ++band) {
    // A band of light goes through the whole row, an object rarely does: the middle one of three thirds' medians.
    std::array<std::array<std::uint16_t, 2 * kBandReach + 1>, 3> counts{};
    std::array<int, 3> number{};
    std::int64_t sum = 0;
    sample_band(reference, present, spans, band, [&](int third, int now, int value) {
      ++counts[third][std::clamp(value - now, -kBandReach, kBandReach) + kBandReach];
      sum += now;
      ++number[third];
    });
    const int total = number[0] + number[1] + number[2];
    const double bright = total ? std::max(static_cast<double>(sum) / total, 16.0) : 16.0;
    std::array<double, 3> middle{};
    for (int third = 0; third < 3; ++third)
      if (number[third] >= 16) middle[third] = median_of_levels(counts[third], number[third], -kBandReach);
    std::sort(middle.begin(), middle.end());
    excess[band] = middle[1] / bright;
    strongest = std::max(strongest, std::abs(middle[1]));
  }
  if (strongest < kLeastBand) return;
  for (int y = 0; y < present.height; ++y) {  // linear between the middles of bands
    const double position = std::clamp((y + 0.5) / kBand - 0.5, 0.0, bands - 1.0);
    const int low = static_cast<int>(position), high = std::min(low + 1, bands - 1);
    const double k = 1 + excess[low] + (position - low) * (excess[high] - excess[low]);
    rows_[y].gain = static_cast<std::int32_t>(std::lround(rows_[y].gain * k));
    rows_[y].offset = static_cast<std::int32_t>(std::lround(rows_[y].offset * k));
  }
}

}  // namespace cerberus::vision
