// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/light.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>

#include "vision/median.h"

namespace cerberus::vision {

namespace {

constexpr int kBand = 8;            // rows; flicker at 100 Hz has a period of 70 rows and more
constexpr int kMaximumBands = 512;  // more are not looked for
constexpr int kColumnStep = 8, kRowStep = 2;
constexpr int kBandReach = 64;     // a band may be this much brighter or darker, 1/256
constexpr int kFullWeight = 64;    // grey levels from which a sample says all it can of a gain
constexpr int kLeastSamples = 48;  // of a band that tells of its light
// Grey levels from which noise makes white. To choose by the present itself would leave out what noise brightens.
constexpr int kNearWhite = 235;
constexpr double kLeastBand = 1.0;    // grey levels: weaker bands are left alone
constexpr double kLeastGlobal = 0.7;  // the same for the picture as a whole

RowSpan span_of(std::span<const RowSpan> spans, int y, int width) {
  return spans.empty() ? RowSpan{0, width} : spans[static_cast<std::size_t>(y)];
}

// 1/256 of a gain that half a grey level is, 8 bits of fraction, by the level it is added to.
constexpr auto kInverse = [] {
  std::array<int, 256> inverse{};
  for (int level = 0; level < 256; ++level) inverse[level] = 128 * 256 / (level ? level : 1);
  return inverse;
}();

// A band of light goes through the whole row, an object rarely does: whether two thirds of a band are mostly brighter, or
// mostly darker. No median is as far from 0 as kLeastBand otherwise.
struct Direction {
  std::array<int, 3> number{}, brighter{}, darker{};
  void add(int third, int difference) {
    ++number[third];
    brighter[third] += difference > 0;
    darker[third] += difference < 0;
  }
  bool one() const {
    int thirds = 0, up = 0, down = 0;
    for (int i = 0; i < 3; ++i) {
      if (number[i] < 8) continue;  // white
      ++thirds;
      up += 2 * brighter[i] > number[i];
      down += 2 * darker[i] > number[i];
    }
    return thirds > 0 && std::max(up, down) >= std::min(thirds, 2);
  }
};

int lit(int value, RowLight light) {
  return std::clamp((value * light.gain + light.offset + 128) >> 8, 0, 255);
}

}  // namespace

void LightChange::clear() {
  none_ = true;
  gain_ = 1;
  offset_ = 0;
  agreement_ = 1;
  std::fill(rows_.begin(), rows_.end(), RowLight{});
}

void LightChange::relight(const std::uint8_t* reference, const std::uint8_t* present, int y, int count,
                          std::uint8_t* out) const {
  const RowLight l = row(y);
  relight_row(reference, l, count, out);
  const int white = (255 * l.gain + l.offset) >> 8;
  if (white >= 255) return;
  for (int x = 0; x < count; ++x) out[x] = reference[x] >= kWhite ? std::max(out[x], present[x]) : out[x];
}

void LightChange::estimate(GrayView reference, GrayView present, std::span<const RowSpan> spans, bool still) {
  rows_.resize(static_cast<std::size_t>(present.height));
  clear();
  if (present.empty()) return;
  const bool line = estimate_global(reference, present, spans);
  const bool bands = estimate_bands(reference, present, spans);
  if (still && line && bands) {
    // Where bright and dark things lie in different bands, the line through all of the picture takes the bands for
    // something that brightness does. Then the bands come first. Which is right shows in what remains.
    const double remains = misfit(reference, present, spans), agreement = agreement_;
    std::array<RowLight, kMaximumBands * kBand> line_first;
    std::ranges::copy(rows_, line_first.begin());
    std::ranges::fill(rows_, RowLight{});
    estimate_bands(reference, present, spans);
    estimate_global(reference, present, spans);
    estimate_bands(reference, present, spans);
    if (misfit(reference, present, spans) > remains) {
      std::copy_n(line_first.begin(), rows_.size(), rows_.begin());
      agreement_ = agreement;
    }
  }
  double gain = 0, offset = 0;
  for (const RowLight& r : rows_) gain += r.gain, offset += r.offset;
  gain_ = gain / (256.0 * present.height);
  offset_ = offset / (256.0 * present.height);
  none_ = std::ranges::all_of(rows_, [](const RowLight& r) { return r == RowLight{}; });
}

// True if there was any.
bool LightChange::estimate_global(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  // 32 bits: a sixteenth of 3840 x 2160 pixels may all be alike.
  std::array<std::array<std::uint32_t, kLevels>, kClasses> counts{};
  std::array<std::uint32_t, 256> seen{};  // samples by level of the reference
  for (int y = 0; y < present.height; y += kRowStep) {
    const RowSpan s = span_of(spans, y, present.width);
    const std::uint8_t *a = reference.row(y), *b = present.row(y);
    for (int x = s.begin + (y / kRowStep) % kColumnStep; x < s.end; x += kColumnStep) {
      const int now = lit(a[x], rows_[y]);
      ++counts[now >> 4][std::clamp(b[x] - now, -kReach, kReach) + kReach];
      ++seen[now];
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
  if (total < 64) return false;

  struct Entry {
    double a, e, weight;
  };
  std::array<Entry, kClasses> points;
  int used = 0;
  for (int k = 0; k < kClasses; ++k) {
    if (number[k] * 100 < total) continue;
    const double a = static_cast<double>(sum[k]) / number[k],
                 e = median_of_levels(counts[k], number[k], -kReach);
    if (a + e > 250 || a + e < 4 || a > 250) continue;  // clipped: says nothing about gain
    points[used++] = {a, e, static_cast<double>(number[k])};
  }
  if (!used) return false;
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
  if (std::max(std::abs(at_zero + 48 * slope), std::abs(at_zero + 208 * slope)) < kLeastGlobal) return false;
  const double gain = std::clamp(1 + slope, 0.25, 4.0);
  for (RowLight& row : rows_) {
    row.gain = static_cast<std::int32_t>(std::lround(row.gain * gain));
    row.offset = static_cast<std::int32_t>(std::lround(row.offset * gain + 256 * at_zero));
  }
  return true;
}

// What remains of the difference, grey levels a sample; objects count little.
double LightChange::misfit(GrayView reference, GrayView present, std::span<const RowSpan> spans) const {
  constexpr int kMost = 16;
  std::int64_t sum = 0, number = 0;
  for (int band = 0; band * kBand < present.height; ++band)
    sample_band(reference, present, spans, band,
                [&](int, int now, int value) { sum += std::min(std::abs(value - now), kMost), ++number; });
  return number ? static_cast<double>(sum) / number : 0;
}

// Calls each(third of the row, value of the reference under the light so far, present value) for the samples of a band.
template <typename Each>
void LightChange::sample_band(GrayView reference, GrayView present, std::span<const RowSpan> spans, int band,
                              Each&& each) const {
  for (int y = band * kBand; y < std::min((band + 1) * kBand, present.height); y += kRowStep) {
    const RowSpan s = span_of(spans, y, present.width);
    const std::uint8_t *a = reference.row(y), *b = present.row(y);
    const RowLight light = rows_[y];
    const bool same = light == RowLight{};
    for (int third = 0, x = s.begin + (y / kRowStep) % kColumnStep; third < 3; ++third)
      for (const int end = std::min(s.end, (third + 1) * present.width / 3); x < end; x += kColumnStep) {
        const int now = same ? a[x] : lit(a[x], light);
        if (a[x] < kWhite && now < kNearWhite) each(third, now, static_cast<int>(b[x]));
      }
  }
}

bool LightChange::may_differ(GrayView reference, GrayView present, std::span<const RowSpan> spans,
                             int band) const {
  Direction direction;
  sample_band(reference, present, spans, band,
              [&](int third, int now, int value) { direction.add(third, value - now); });
  return direction.one();
}

// True if there were any.
bool LightChange::estimate_bands(GrayView reference, GrayView present, std::span<const RowSpan> spans) {
  const int bands = (present.height + kBand - 1) / kBand;
  if (bands < 4 || bands > kMaximumBands) return false;
  int first = 0;
  while (first < bands && !may_differ(reference, present, spans, first)) ++first;
  if (first == bands) return false;
  std::array<double, kMaximumBands> excess;  // gain of the band, minus 1
  std::bitset<kMaximumBands> known;
  double strongest = 0;
  for (int band = 0; band < bands; ++band) {
    // The median of what the samples say of the gain, in 1/256.
    // In the dark they say little; and whole levels make steps there, so half of each is counted half a level either way.
    std::array<std::uint32_t, 2 * kBandReach + 1> counts{};
    Direction direction;
    int samples = 0;
    std::int64_t weights = 0, sum = 0;
    sample_band(reference, present, spans, band, [&](int third, int now, int value) {
      direction.add(third, value - now);
      const int weight = std::min(now, kFullWeight), inverse = kInverse[now];
      for (const int half : {-1, 1}) {
        const int excess = ((2 * (value - now) + half) * inverse) >> 8;
        counts[std::clamp(excess, -kBandReach, kBandReach) + kBandReach] += weight;
      }
      weights += 2 * weight;
      sum += now;
      ++samples;
    });
    known[band] = samples >= kLeastSamples && weights > 0;
    if (!known[band]) continue;
    excess[band] =
        direction.one() ? median_of_levels(counts, static_cast<double>(weights), -kBandReach) / 256 : 0;
    strongest = std::max(strongest, std::abs(excess[band]) * sum / samples);
  }
  if (strongest < kLeastBand) return false;
  // Where all is white or hidden, the bands next to it tell.
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
  for (int y = 0; y < present.height; ++y) {  // linear between the middles of bands, and beyond the outermost
    const double position = (y + 0.5) / kBand - 0.5;
    const int low = std::clamp(static_cast<int>(position), 0, bands - 2);
    const double k = 1 + excess[low] + (position - low) * (excess[low + 1] - excess[low]);
    rows_[y].gain = static_cast<std::int32_t>(std::lround(rows_[y].gain * k));
    rows_[y].offset = static_cast<std::int32_t>(std::lround(rows_[y].offset * k));
  }
  return true;
}

}  // namespace cerberus::vision
