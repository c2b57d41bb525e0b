// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/background_light.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace cerberus::vision {
namespace {

// Grey levels brighter or darker than a memory may be compared with: before a still scene lamps may flicker by that
// much.
constexpr double kOtherLight = 3, kFlicker = 40;
constexpr double kStep = 12;  // grey levels from one frame to the next: a step of the exposure, not flicker
// Share of pixels a change of light has to explain, else it is another scene.
constexpr double kAgreement = 0.3;

}  // namespace

void BackgroundLight::preallocate(Size picture) {
  known_.resize({picture.width + 2 * kMargin, picture.height + 2});
  row_.resize({picture.width, 1});
}

MutableGrayView BackgroundLight::known() {
  const auto v = known_.view();
  return {v.data + v.stride + kMargin, v.width - 2 * kMargin, v.height - 2, v.stride};
}

void BackgroundLight::repeat_borders() {
  const MutableGrayView k = known();
  for (int y = 0; y < k.height; ++y) {
    std::uint8_t* row = k.row(y);
    row[-1] = row[0];
    row[k.width] = row[k.width - 1];
  }
  const std::size_t bytes = static_cast<std::size_t>(k.width) + 2;
  std::memcpy(k.row(-1) - 1, k.row(0) - 1, bytes);
  std::memcpy(k.row(k.height) - 1, k.row(k.height - 1) - 1, bytes);
}

void BackgroundLight::draw(View<const std::uint16_t> mean) {
  const MutableGrayView k = known();
  for (int y = 0; y < k.height; ++y) round_row(mean.row(y), k.width, k.row(y));
  repeat_borders();
}

void BackgroundLight::estimate(GrayView present, std::span<const RowSpan> shown, bool still) {
  samples_.take(known(), present, shown);
  change_.estimate(samples_, still);
}

// known, as it was drawn, under the light of the present.
void BackgroundLight::relight(GrayView present) {
  const MutableGrayView k = known();
  for (int y = 0; y < k.height; ++y) change_.relight(k.row(y), present.row(y), y, k.width, k.row(y));
  repeat_borders();
}

void BackgroundLight::relight_rows(GrayView present, std::span<const RowSpan> shown) {
  estimate(present, shown, true);
  if (change_.agreement() >= kAgreement && !change_.none()) relight(present);
  change_.clear();
}

// White stays white: it may have been anything from there on.
const std::uint8_t* BackgroundLight::remembered(int y, const std::uint8_t* present) {
  const RowLight light = change_.row(y);
  if (light == RowLight{}) return present;
  const auto whole = [&](double v) { return static_cast<std::int32_t>(std::lround(v * 256 / light.gain)); };
  const MutableGrayView row = row_.view();
  relight_row(present, {whole(256), whole(-light.offset)}, row.width, row.data);
  for (int x = 0; x < row.width; ++x) row.data[x] = present[x] >= kWhite ? present[x] : row.data[x];
  return row.data;
}

bool BackgroundLight::is_other() const {
  return std::abs(brighter_) > kOtherLight;
}

void BackgroundLight::adopt(const BackgroundPixels& pixels, Mosaic& surroundings,
                            std::span<const RowSpan> shown) {
  const int gain = static_cast<int>(std::lround(change_.gain() * 256));
  const int offset = static_cast<int>(std::lround(change_.offset() * 256));
  const MutableGrayView k = known();
  for (int y = 0; y < pixels.mean.height; ++y) {
    const RowSpan span = shown.empty() ? RowSpan{} : shown[static_cast<std::size_t>(y)];
    std::uint16_t* row = pixels.mean.row(y);
    std::uint8_t* age = pixels.age.row(y);
    const auto relit = [&](int then) { return std::clamp((then * gain >> 8) + offset, 0, 255 << 8); };
    int brightest = 0;
    for (int x = 0; x < pixels.mean.width; ++x) brightest = std::max(brightest, int{row[x]});
    if (std::max(brightest, relit(brightest)) < kNearWhite << 8) {  // most rows
      for (int x = 0; x < pixels.mean.width; ++x) row[x] = static_cast<std::uint16_t>(relit(row[x]));
      continue;
    }
    for (int x = 0; x < pixels.mean.width; ++x) {
      const int then = row[x], now = relit(then);
      row[x] = static_cast<std::uint16_t>(now);
      if (!age[x]) continue;
      if (x >= span.begin && x < span.end) {
        if (std::max(then, now) < kNearWhite << 8) continue;
        row[x] = static_cast<std::uint16_t>(k.at(x, y) << 8);
        age[x] = std::min(age[x], kRelearn);
      } else if (then >= kWhite << 8 && now < then) {
        age[x] = 0;
      }
    }
  }
  surroundings.relight(gain, offset);
  begin();
}

bool BackgroundLight::compensate(const BackgroundPixels& pixels, Mosaic& surroundings, GrayView present,
                                 std::span<const RowSpan> shown, bool still) {
  const double before = brighter_;
  estimate(present, shown, still);
  brighter_ = change_.gain() * 128 + change_.offset() - 128;
  const bool step = std::abs(brighter_ - before) > kStep;
  if (change_.agreement() < kAgreement && still) {  // not a change of light: another scene
    for (int y = 0; y < present.height; ++y) std::fill_n(pixels.age.row(y), present.width, std::uint8_t{0});
    surroundings.begin(present.size());
    begin();
    return false;
  }
  if (change_.none()) return step;
  // Flicker comes back, and what it makes white in the memory is lost: the memory keeps the light it was learnt in. A
  // stronger change is there to stay.
  if (std::abs(brighter_) > (still ? kFlicker : kOtherLight)) {
    relight(present);
    adopt(pixels, surroundings, shown);
    draw(pixels.mean);
    estimate(present, shown, still);
  }
  relight(present);
  return step;
}

void BackgroundLight::forgive_step(const BackgroundPixels& pixels, GrayView present, BitView foreground,
                                   const std::array<double, kBrightness>& sigma, MutableBitView moved) {
  const MutableGrayView k = known();
  intersect(moved, foreground, moved);
  for (int y = 0; y < k.height; ++y) {
    const std::uint64_t* there = foreground.row(y);
    const std::uint8_t* f = present.row(y);
    const std::uint8_t* taken = remembered(y, f);
    std::uint8_t* m = k.row(y);
    std::uint8_t* a = pixels.age.row(y);
    for (int x = 0; x < k.width; ++x) {
      const bool free = !(there[x / 64] >> (x % 64) & 1);
      if (!free || std::abs(f[x] - m[x]) <= 2 * sigma[m[x] >> 4]) continue;
      pixels.mean.at(x, y) = static_cast<std::uint16_t>(taken[x] << 8);
      m[x] = f[x];
      a[x] = std::min(a[x], kRelearn);
    }
  }
}

}  // namespace cerberus::vision
