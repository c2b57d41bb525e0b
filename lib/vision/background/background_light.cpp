// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/background_light.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

namespace cerberus::vision {
namespace {

// Origin unknown: kept from the first version. Guard of all: unit-background_light, and flicker, bands and exposure steps
// in unit-foreground_mask.
constexpr struct Parameters {
  // Grey levels from which a change of light is adopted: for a moving camera, and for a standing one, whose lamps may
  // flicker by that much.
  double other_light = 3, flicker = 40;
  double step = 12;        // grey levels from one frame to the next: a step of the exposure, not flicker
  double agreement = 0.3;  // share of pixels that a change of light must explain, else it is another scene
  double noise = 2;        // sigmas by which a pixel differs from the relit background after a step
} kParameters;

}  // namespace

void BackgroundLight::preallocate(Size picture) {
  background_.resize({picture.width + 2 * kMargin, picture.height + 2});
  row_.resize({picture.width, 1});
}

MutableGrayView BackgroundLight::background() {
  const auto v = background_.view();
  return {v.data + v.stride + kMargin, v.width - 2 * kMargin, v.height - 2, v.stride};
}

void BackgroundLight::repeat_borders() {
  const MutableGrayView k = background();
  for (int y = 0; y < k.height; ++y) {
    std::uint8_t* row = k.row(y);
    row[-1] = row[0];
    row[k.width] = row[k.width - 1];
  }
  const std::size_t bytes = static_cast<std::size_t>(k.width) + 2;
  std::memcpy(k.row(-1) - 1, k.row(0) - 1, bytes);
  std::memcpy(k.row(k.height) - 1, k.row(k.height - 1) - 1, bytes);
}

void BackgroundLight::load(View<const std::uint16_t> mean) {
  const MutableGrayView k = background();
  for (int y = 0; y < k.height; ++y) round_row(mean.row(y), k.width, k.row(y));
  repeat_borders();
}

void BackgroundLight::estimate(GrayView frame, std::span<const RowSpan> visible, bool still) {
  samples_.take(background(), frame, visible);
  change_.estimate(samples_, still);
}

// Brings background(), as loaded, under the light of the frame.
void BackgroundLight::relight(GrayView frame) {
  const MutableGrayView k = background();
  for (int y = 0; y < k.height; ++y) change_.relight(k.row(y), frame.row(y), y, k.width, k.row(y));
  repeat_borders();
}

void BackgroundLight::relight_rows(GrayView frame, std::span<const RowSpan> visible) {
  estimate(frame, visible, true);
  if (change_.agreement() >= kParameters.agreement && !change_.none()) relight(frame);
  change_.clear();
}

// White stays white: the sensor was saturated, and the brightness is undetermined.
const std::uint8_t* BackgroundLight::in_background_light(int y, const std::uint8_t* frame) {
  const RowLight light = change_.row(y);
  if (light == RowLight{}) return frame;
  const auto whole = [&](double v) { return static_cast<std::int32_t>(std::lround(v * 256 / light.gain)); };
  const MutableGrayView row = row_.view();
  relight_row(frame, {whole(256), whole(-light.offset)}, row.width, row.data);
  for (int x = 0; x < row.width; ++x) row.data[x] = frame[x] >= kWhite ? frame[x] : row.data[x];
  return row.data;
}

bool BackgroundLight::is_different() const {
  return std::abs(brighter_) > kParameters.other_light;
}

void BackgroundLight::adopt(const BackgroundPixels& pixels, Mosaic& mosaic,
                            std::span<const RowSpan> visible) {
  const int gain = static_cast<int>(std::lround(change_.gain() * 256));
  const int offset = static_cast<int>(std::lround(change_.offset() * 256));
  const MutableGrayView k = background();
  for (int y = 0; y < pixels.mean.height; ++y) {
    const RowSpan span = visible.empty() ? RowSpan{} : visible[static_cast<std::size_t>(y)];
    std::uint16_t* row = pixels.mean.row(y);
    std::uint8_t* age = pixels.age.row(y);
    const auto relit = [&](int then) { return std::clamp((then * gain >> 8) + offset, 0, 255 << 8); };
    int brightest = 0;
    for (int x = 0; x < pixels.mean.width; ++x) brightest = std::max(brightest, int{row[x]});
    if (std::max(brightest, relit(brightest)) < kNearWhite << 8) {  // no white: most rows
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
  mosaic.relight(gain, offset);
  reset();
}

bool BackgroundLight::compensate(const BackgroundPixels& pixels, Mosaic& mosaic, GrayView frame,
                                 std::span<const RowSpan> visible, bool still) {
  const double before = brighter_;
  estimate(frame, visible, still);
  brighter_ = change_.gain() * 128 + change_.offset() - 128;
  const bool step = std::abs(brighter_ - before) > kParameters.step;
  if (change_.agreement() < kParameters.agreement && still) {  // another scene
    for (int y = 0; y < frame.height; ++y) std::fill_n(pixels.age.row(y), frame.width, std::uint8_t{0});
    mosaic.reset(frame.size());
    reset();
    return false;
  }
  if (change_.none()) return step;
  // Flicker is periodic, and a model that followed it would lose its whites: the model keeps its light. A stronger
  // change lasts.
  if (std::abs(brighter_) > (still ? kParameters.flicker : kParameters.other_light)) {
    relight(frame);
    adopt(pixels, mosaic, visible);
    load(pixels.mean);
    estimate(frame, visible, still);
  }
  relight(frame);
  return step;
}

void BackgroundLight::suppress_step(const BackgroundPixels& pixels, GrayView frame, BitView foreground,
                                    const std::array<double, kBrightness>& sigma, MutableBitView moved) {
  const MutableGrayView k = background();
  intersect(moved, foreground, moved);
  for (int y = 0; y < k.height; ++y) {
    const std::uint64_t* there = foreground.row(y);
    const std::uint8_t* f = frame.row(y);
    const std::uint8_t* taken = in_background_light(y, f);
    std::uint8_t* m = k.row(y);
    std::uint8_t* a = pixels.age.row(y);
    for (int x = 0; x < k.width; ++x) {
      const bool free = !bit_at(there, x);
      if (!free || std::abs(f[x] - m[x]) <= kParameters.noise * sigma[m[x] >> 4]) continue;
      pixels.mean.at(x, y) = static_cast<std::uint16_t>(taken[x] << 8);
      m[x] = f[x];
      a[x] = std::min(a[x], kRelearn);
    }
  }
}

}  // namespace cerberus::vision
