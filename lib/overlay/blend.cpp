// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/blend.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "overlay/blend_kernels.h"

namespace cerberus::overlay {

namespace {

// Rows of the picture that are prefetched ahead of the one at hand: rows of a large frame lie further apart than
// processors prefetch by themselves (derived: 8 rows of 16 pixels take longer than a load from memory).
constexpr int kAhead = 8;

void look_ahead(const std::uint8_t* row, std::ptrdiff_t bytes) {
  constexpr std::ptrdiff_t kLine = 64;
  for (std::ptrdiff_t at = 0; at < bytes; at += kLine) __builtin_prefetch(row + at, 1);
  __builtin_prefetch(row + bytes - 1, 1);
}

constexpr int kTile = 64;  // samples that are weighed, or skipped if all are transparent, at once

std::int32_t fixed(double weight) {
  return static_cast<std::int32_t>(std::lround(weight * 65536));
}

// The rows `top` and, where a sample stands for two, `bottom` of the drawing on one row of samples. `left`: the column
// of the sample at `to` at which the drawing begins, of the pixels that it stands for.
struct SampleRow {
  WeightedRow weights;
  int count = 1, left = 0, width = 0;  // pixels side by side a sample stands for; of the drawing
  int shift = 0;                       // 2^shift pixels a sample
  std::uint8_t* to = nullptr;
  int step = 1;

  void blend_one(int first, int last) {
    std::int32_t value, rest;
    weigh_sample(weights, weights.top + first, weights.bottom ? weights.bottom + first : nullptr,
                 last - first, value, rest);
    if (rest != weights.full) *to = mix_sample(value, rest, shift, *to);
    to += step;
  }

  void blend() {
    int x = 0;
    if (left > 0)
      blend_one(0, x = std::min(count - left, width));  // a sample that the drawing covers in part
    if (count > 2) {
      for (; x + count <= width; x += count) blend_one(x, x + count);
    } else {
      const WeightedRow all = weights;
      for (int samples; (samples = std::min(kTile, (width - x) / count)) > 0; x += samples * count) {
        weights.top = all.top + x;
        weights.bottom = all.bottom ? all.bottom + x : nullptr;
        weights.samples = samples;
        blend_tile();
      }
      weights = all;
    }
    if (x < width) blend_one(x, width);
  }

  void blend_tile() {
    std::int32_t value[kTile], rest[kTile];
    if (weigh(weights, value, rest)) {
      if (step == 1)
        mix(value, rest, shift, weights.samples, to);
      else
        for (int i = 0; i < weights.samples; ++i)
          if (rest[i] != weights.full) to[i * step] = mix_sample(value[i], rest[i], shift, to[i * step]);
    }
    to += static_cast<std::ptrdiff_t>(weights.samples) * step;
  }
};

void blend_component(vision::View<const std::uint32_t> drawing, int x, int y, const BlendComponent& c) {
  SampleRow row;
  row.count = 1 << c.shift_x;
  row.left = x & (row.count - 1);
  row.width = drawing.width;
  row.shift = c.shift_x + c.shift_y;
  row.step = c.step;
  row.weights.pairs = row.count == 2;
  row.weights.full = 255 << row.shift;
  row.weights.red = fixed(c.red), row.weights.green = fixed(c.green), row.weights.blue = fixed(c.blue);
  row.weights.alpha = fixed(c.offset / 255);
  const int bottom = y + drawing.height;
  for (int v = y >> c.shift_y; v << c.shift_y < bottom; ++v) {
    const int first = std::max(v << c.shift_y, y) - y, end = std::min((v + 1) << c.shift_y, bottom) - y;
    row.weights.top = drawing.row(first);
    row.weights.bottom = end - first > 1 ? drawing.row(first + 1) : nullptr;
    if ((v + kAhead) << c.shift_y < bottom)
      look_ahead(c.data + (v + kAhead) * c.stride + static_cast<std::ptrdiff_t>(x >> c.shift_x) * c.step,
                 static_cast<std::ptrdiff_t>(drawing.width >> c.shift_x) * c.step);
    row.to = c.data + v * c.stride + static_cast<std::ptrdiff_t>(x >> c.shift_x) * c.step;
    row.blend();
  }
}

// A component of more than 8 bits. Sums of bytes over n pixels times 16.16 weights are in 64 bits.
class WordBlender {
 public:
  explicit WordBlender(const BlendComponent& c)
      : c_(c),
        red_(fixed(c.red)),
        green_(fixed(c.green)),
        blue_(fixed(c.blue)),
        alpha_(fixed(c.offset / 255)) {}

  void blend(vision::View<const std::uint32_t> drawing, int x, int y) const {
    const int right = x + drawing.width, bottom = y + drawing.height;
    for (int v = y >> c_.shift_y; v << c_.shift_y < bottom; ++v) {
      const int top = std::max(v << c_.shift_y, y) - y, end = std::min((v + 1) << c_.shift_y, bottom) - y;
      std::uint8_t* to = c_.data + v * c_.stride + static_cast<std::ptrdiff_t>(x >> c_.shift_x) * c_.step;
      for (int u = x >> c_.shift_x; u << c_.shift_x < right; ++u, to += c_.step) {
        const int left = std::max(u << c_.shift_x, x) - x, stop = std::min((u + 1) << c_.shift_x, right) - x;
        std::int64_t r = 0, g = 0, b = 0, a = 0;
        for (int row = top; row < end; ++row)
          for (int i = left; i < stop; ++i) {
            const std::uint32_t p = drawing.row(row)[i];
            r += p >> 16 & 255, g += p >> 8 & 255, b += p & 255, a += p >> 24;
          }
        if (a > 0) mix(to, red_ * r + green_ * g + blue_ * b + alpha_ * a, a);
      }
    }
  }

 private:
  void mix(std::uint8_t* to, std::int64_t value, std::int64_t alpha) const {
    const int pixels = 1 << (c_.shift_x + c_.shift_y);
    std::uint16_t word;
    std::memcpy(&word, to, sizeof word);
    const std::int64_t before = order(word) >> c_.word_shift;
    const std::int64_t rest = before * (255 * pixels - alpha) * 65536 / 255;
    const std::int64_t mixed = ((value + rest) / pixels + 32768) >> 16;
    word = order(static_cast<int>(std::clamp<std::int64_t>(mixed, 0, (1 << c_.bits) - 1) << c_.word_shift));
    std::memcpy(to, &word, sizeof word);
  }
  std::uint16_t order(int word) const {
    return static_cast<std::uint16_t>(c_.swapped ? (word << 8 | (word >> 8 & 255)) : word);
  }

  const BlendComponent& c_;
  std::int64_t red_, green_, blue_, alpha_;
};

// Returns the byte of a pixel for each component if pixels have four bytes, each of which takes one colour; else
// nullopt.
std::optional<PackedLayout> packed_layout(std::span<const BlendComponent> picture) {
  if (picture.empty() || !picture[0].pixel) return std::nullopt;
  PackedLayout layout;
  for (const BlendComponent& c : picture) {
    const std::ptrdiff_t at = c.data - picture[0].pixel;
    if (c.step != 4 || c.shift_x || c.shift_y || c.pixel != picture[0].pixel || c.stride != picture[0].stride)
      return std::nullopt;
    const double parts[4] = {c.blue, c.green, c.red, c.offset / 255};  // as the bytes of a word rise
    if (std::count(parts, parts + 4, 0.0) != 3) return std::nullopt;
    const auto one = std::find(parts, parts + 4, 1.0);
    if (one == parts + 4) return std::nullopt;
    const auto place = static_cast<std::uint8_t>(one - parts);
    layout.color[at] =
        std::endian::native == std::endian::little ? place : static_cast<std::uint8_t>(3 - place);
  }
  return layout;
}

}  // namespace

void blend(vision::View<const std::uint32_t> drawing, int x, int y, std::span<const BlendComponent> picture) {
  if (const auto layout = packed_layout(picture)) {
    std::uint8_t* to = picture[0].pixel + y * picture[0].stride + 4 * static_cast<std::ptrdiff_t>(x);
    for (int row = 0; row < drawing.height; ++row, to += picture[0].stride) {
      if (row + kAhead < drawing.height)
        look_ahead(to + kAhead * picture[0].stride, 4 * static_cast<std::ptrdiff_t>(drawing.width));
      blend_packed(drawing.row(row), *layout, drawing.width, to);
    }
    return;
  }
  for (const BlendComponent& component : picture) {
    if (component.bits > 8)
      WordBlender(component).blend(drawing, x, y);
    else
      blend_component(drawing, x, y, component);
  }
}

}  // namespace cerberus::overlay
