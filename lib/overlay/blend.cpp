// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/blend.h"

#include <algorithm>
#include <cmath>

namespace cerberus::overlay {

namespace {

// 16.16 weights of a component: of red, green and blue times alpha, and of alpha itself.
struct Weights {
  std::int32_t red, green, blue, alpha;

  explicit Weights(const BlendComponent& c)
      : red(fixed(c.red)), green(fixed(c.green)), blue(fixed(c.blue)), alpha(fixed(c.offset / 255)) {}
  static std::int32_t fixed(double weight) { return static_cast<std::int32_t>(std::lround(weight * 65536)); }

  // Sums of bytes over n pixels to n x 65536 times the component; 64 bits hold any weights and 16 pixels.
  std::int64_t operator()(std::int64_t r, std::int64_t g, std::int64_t b, std::int64_t a) const {
    return red * r + green * g + blue * b + alpha * a;
  }
};

std::uint8_t byte(std::int64_t value) {
  return static_cast<std::uint8_t>(std::clamp<std::int64_t>(value, 0, 255));
}

void blend_full(vision::View<const std::uint32_t> drawing, int x, int y, const BlendComponent& c) {
  const Weights weights(c);
  for (int row = 0; row < drawing.height; ++row) {
    const std::uint32_t* from = drawing.row(row);
    std::uint8_t* to = c.data + (y + row) * c.stride + static_cast<std::ptrdiff_t>(x) * c.step;
    for (int i = 0; i < drawing.width; ++i, to += c.step) {
      const std::uint32_t p = from[i];
      if (p == 0) continue;  // most of a drawing
      const std::int64_t value = weights(p >> 16 & 255, p >> 8 & 255, p & 255, p >> 24);
      const std::int64_t rest = *to * static_cast<std::int64_t>(255 - (p >> 24)) * 65536 / 255;
      *to = byte((value + rest + 32768) >> 16);
    }
  }
}

void blend_subsampled(vision::View<const std::uint32_t> drawing, int x, int y, const BlendComponent& c) {
  const Weights weights(c);
  const int pixels = 1 << (c.shift_x + c.shift_y);
  const int right = x + drawing.width, bottom = y + drawing.height;
  for (int v = y >> c.shift_y; v << c.shift_y < bottom; ++v) {
    const int top = std::max(v << c.shift_y, y), end = std::min((v + 1) << c.shift_y, bottom);
    std::uint8_t* to = c.data + v * c.stride + static_cast<std::ptrdiff_t>(x >> c.shift_x) * c.step;
    for (int u = x >> c.shift_x; u << c.shift_x < right; ++u, to += c.step) {
      const int left = std::max(u << c.shift_x, x) - x, stop = std::min((u + 1) << c.shift_x, right) - x;
      std::uint32_t r = 0, g = 0, b = 0, a = 0;
      for (int row = top; row < end; ++row) {
        const std::uint32_t* from = drawing.row(row - y);
        for (int i = left; i < stop; ++i) {
          const std::uint32_t p = from[i];
          r += p >> 16 & 255, g += p >> 8 & 255, b += p & 255, a += p >> 24;
        }
      }
      if (a == 0) continue;
      const std::int64_t value = weights(r, g, b, a);
      const std::int64_t rest =
          *to * static_cast<std::int64_t>(255 * pixels - static_cast<int>(a)) * 65536 / 255;
      *to = byte(((value + rest) / pixels + 32768) >> 16);
    }
  }
}

}  // namespace

void blend(vision::View<const std::uint32_t> drawing, int x, int y, std::span<const BlendComponent> picture) {
  for (const BlendComponent& component : picture) {
    if (component.shift_x == 0 && component.shift_y == 0)
      blend_full(drawing, x, y, component);
    else
      blend_subsampled(drawing, x, y, component);
  }
}

}  // namespace cerberus::overlay
