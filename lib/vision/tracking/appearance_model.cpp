// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/appearance_model.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {
namespace {

constexpr double kLowest = 3, kHighest = 8.05;  // log2 of 0 and of 255, each plus AppearanceParameters::dark
constexpr int kShares = 16;                     // a pixel is shared between two bins in 1/16

}  // namespace

BrightnessLevel::BrightnessLevel(const AppearanceParameters& parameters) : parameters_(parameters) {
  make_bins();
}

void BrightnessLevel::reset() {
  level_ = 0;
  size_ = {};
  make_bins();
}

void BrightnessLevel::make_bins() {
  const AppearanceParameters& q = parameters_;
  const double usual = std::exp2(-level_);
  for (int grey = 0; grey < 256; ++grey) {
    const double at =
        (std::log2(grey * usual + q.dark) - kLowest) / (kHighest - kLowest) * AppearanceModel::kBins - 0.5;
    const double inside = std::clamp(at, 0.0, AppearanceModel::kBins - 1.0);
    const int first = std::min(static_cast<int>(inside), AppearanceModel::kBins - 2);
    bins_[grey] = {static_cast<std::uint8_t>(first),
                   static_cast<std::uint8_t>(std::lround((inside - first) * kShares))};
  }
}

// The median change of grid points carried with the scene: people cover few of them.
void BrightnessLevel::update(GrayView luma, const Transform& motion) {
  std::array<double, kColumns * kRows> ratio;
  int count = 0;
  const auto place = [&](int i) {
    return Point{(i % kColumns + 0.5) * luma.width / kColumns, (i / kColumns + 0.5) * luma.height / kRows};
  };
  const auto grey = [&](int x, int y) { return luma.at(x, y); };
  if (luma.size() == size_) {
    for (int i = 0; i < kColumns * kRows; ++i) {
      const Point p = motion.apply(place(i));
      if (!(p.x >= 0 && p.y >= 0 && p.x < luma.width && p.y < luma.height)) continue;
      const int now = grey(static_cast<int>(p.x), static_cast<int>(p.y)), then = before_[i];
      if (now == 0 || then == 0) continue;
      ratio[count++] = std::log2(static_cast<double>(now) / then);
    }
  }
  if (count > 0) {
    const auto middle = ratio.begin() + count / 2;
    std::nth_element(ratio.begin(), middle, ratio.begin() + count);
    if (*middle != 0) {  // else the bins are still right
      level_ += *middle;
      make_bins();
    }
  }
  size_ = luma.size();
  for (int i = 0; i < kColumns * kRows; ++i) {
    const Point p = place(i);
    before_[i] = grey(static_cast<int>(p.x), static_cast<int>(p.y));
  }
}

bool AppearanceModel::known() const {
  return std::ranges::any_of(share, [](const auto& band) {
    return std::ranges::any_of(band, [](std::uint16_t s) { return s != 0; });
  });
}

void AppearanceModel::learn(const AppearanceModel& seen, double weight) {
  for (int b = 0; b < kBands; ++b) {
    const auto empty = [](const auto& band) {
      return std::ranges::all_of(band, [](std::uint16_t s) { return s == 0; });
    };
    if (empty(seen.share[b])) continue;
    const double w = empty(share[b]) ? 1 : weight;
    for (int i = 0; i < kBins; ++i)
      share[b][i] =
          static_cast<std::uint16_t>(std::lround(share[b][i] + w * (seen.share[b][i] - share[b][i])));
  }
}

AppearanceModel appearance_of(const Sight& sight, const BrightnessLevel& level, const Box& box, int samples) {
  AppearanceModel look;
  const int x0 = std::max(0, static_cast<int>(std::lround(box.x)));
  const int x1 = std::min(sight.luma.width, static_cast<int>(std::lround(box.right())));
  const double whole = box.area();
  const bool all_of_it = sight.mask.empty();
  if (!(whole > 0) || x1 <= x0) return look;
  const int step = std::max(1, static_cast<int>(std::lround(std::sqrt(whole / samples))));
  for (int b = 0; b < AppearanceModel::kBands; ++b) {
    const int y0 =
        std::max(0, static_cast<int>(std::lround(box.y + box.height * b / AppearanceModel::kBands)));
    const int y1 =
        std::min(sight.luma.height,
                 static_cast<int>(std::lround(box.y + box.height * (b + 1) / AppearanceModel::kBands)));
    std::array<std::uint32_t, AppearanceModel::kBins> counts{};
    std::uint32_t count = 0;
    for (int y = y0 + step / 2; y < y1; y += step) {
      const std::uint8_t* luma = sight.luma.row(y);
      const std::uint8_t* mask = all_of_it ? nullptr : sight.mask.row(y);
      for (int x = x0 + step / 2; x < x1; x += step) {
        if (mask && !mask[x]) continue;
        const BrightnessLevel::Bin bin = level.bin(luma[x]);
        counts[bin.first] += kShares - bin.share;
        counts[bin.first + 1] += bin.share;
        ++count;
      }
    }
    if (count == 0) continue;
    for (int i = 0; i < AppearanceModel::kBins; ++i)
      look.share[b][i] =
          static_cast<std::uint16_t>(counts[i] * std::uint64_t{AppearanceModel::kAll} / (count * kShares));
  }
  return look;
}

double appearance_distance(const AppearanceModel& a, const AppearanceModel& b) {
  int different = 0, bands = 0;
  for (int k = 0; k < AppearanceModel::kBands; ++k) {
    int sum_a = 0, sum_b = 0, difference = 0;
    for (int i = 0; i < AppearanceModel::kBins; ++i) {
      sum_a += a.share[k][i];
      sum_b += b.share[k][i];
      difference += std::abs(a.share[k][i] - b.share[k][i]);
    }
    if (sum_a == 0 || sum_b == 0) continue;
    different += difference;
    ++bands;
  }
  return bands == 0 ? -1 : std::min(1.0, different / (2.0 * AppearanceModel::kAll * bands));
}

}  // namespace cerberus::vision
