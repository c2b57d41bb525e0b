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

std::int32_t fixed(double weight) {
  return static_cast<std::int32_t>(std::lround(weight * 65536));
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
    return blend_packed(drawing, *layout, to, picture[0].stride);
  }
  // Neighbours in the list whose samples stand for the same pixels are blended together.
  PlaneGroup group;
  const auto blend_group = [&] {
    if (group.count > 0) blend_planes(drawing, x, y, group);
    group.count = 0;
  };
  for (const BlendComponent& c : picture) {
    if (c.bits > 8) {
      WordBlender(c).blend(drawing, x, y);
      continue;
    }
    if (group.count == PlaneGroup::kMost || c.shift_x != group.shift_x || c.shift_y != group.shift_y)
      blend_group();
    group.shift_x = c.shift_x, group.shift_y = c.shift_y;
    group.planes[group.count++] = {
        c.data, c.stride, c.step, fixed(c.red), fixed(c.green), fixed(c.blue), fixed(c.offset / 255)};
  }
  blend_group();
}

}  // namespace cerberus::overlay
