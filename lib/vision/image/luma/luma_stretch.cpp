// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/luma/luma_stretch.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <span>

namespace cerberus::vision {

namespace {

constexpr LumaStretchParameters kParameters;

}  // namespace

LumaStretch::Levels LumaStretch::levels_of(const LumaSource& source) {
  const int columns = std::min(source.width, kColumns), rows = std::min(source.height, kRows);
  std::size_t count = 0;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const std::ptrdiff_t x = (2 * i + 1) * std::int64_t{source.width} / (2 * columns);
      const std::ptrdiff_t y = (2 * j + 1) * std::int64_t{source.height} / (2 * rows);
      std::uint16_t word;
      std::memcpy(&word, source.data + y * source.stride + x * source.pixel_stride, sizeof word);
      samples_[count++] = source.swapped ? static_cast<std::uint16_t>(word << 8 | word >> 8) : word;
    }
  const std::span all(samples_.data(), count);
  const auto level = [&](double share) {
    const auto place = all.begin() + std::lround(share * static_cast<double>(count - 1));
    std::ranges::nth_element(all, place);
    return int{*place};
  };
  const LumaStretchParameters& p = kParameters;
  return {level(p.outliers), level(p.outside), level(0.5), level(1 - p.outside), level(1 - p.outliers)};
}

// range: values of the format.
LumaStretch::Part LumaStretch::part_for(const Levels& levels, double range) {
  const LumaStretchParameters& p = kParameters;
  const double values = levels.brightest - levels.darkest;
  if (values >= p.narrow * range) return {0, range};
  const double span = std::max(p.least * range, (1 + 2 * p.margin) * values);
  return {std::clamp((levels.brightest + levels.darkest - span) / 2, 0.0, range - span), span};
}

void LumaStretch::follow(const Levels& levels, double range) {
  const LumaStretchParameters& p = kParameters;
  const Part wanted = part_for(levels, range);
  const double high = part_.low + part_.span;
  if (part_.span == 0 || levels.middle < part_.low || levels.middle > high ||
      levels.bright - levels.dark > 2 * part_.span) {
    part_ = wanted, moves_ = false;
    return;
  }
  moves_ = moves_ || levels.dark < part_.low || levels.bright > high ||
           levels.bright - levels.dark < p.filled * part_.span;
  if (!moves_) return;
  const double step = p.step * part_.span, up = wanted.low - part_.low,
               down = high - wanted.low - wanted.span;
  part_.low += std::clamp(up, -step, step);
  part_.span = high - std::clamp(down, -step, step) - part_.low;
  moves_ = std::max(std::abs(up), std::abs(down)) > step;
}

LumaSource LumaStretch::stretched(const LumaSource& source) {
  if (source.word_shift == 0 || source.width <= 0 || source.height <= 0) return source;
  const double range = 256 << source.word_shift;
  const Levels levels = levels_of(source);
  if (part_.span == 0 && levels.brightest - levels.darkest < kParameters.even * range) return source;
  // A picture that is shown again gives the same luma again.
  if (part_.span == 0 || levels != last_) follow(levels, range), last_ = levels;
  LumaSource result = source;
  if (part_.span >= range) return result;
  result.low = static_cast<int>(part_.low);
  result.span = std::min(static_cast<int>(part_.span), 65535 - result.low);
  return result;
}

}  // namespace cerberus::vision
