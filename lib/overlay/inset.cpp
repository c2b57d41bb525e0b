// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/inset.h"

#include <algorithm>
#include <cmath>

namespace cerberus::overlay {

namespace {

// Returns the share of [at, at + 1) that lies in [low, high).
double share(int at, double low, double high) {
  return std::clamp(std::min(at + 1.0, high) - std::max(static_cast<double>(at), low), 0.0, 1.0);
}

}  // namespace

vision::Size inset_size(vision::Size scene, vision::Size frame) {
  if (scene.width <= 0 || scene.height <= 0) return {};
  const double scale = std::min(0.3 * frame.width / scene.width, 0.4 * frame.height / scene.height);
  const vision::Size size{static_cast<int>(std::lround(scale * scene.width)),
                          static_cast<int>(std::lround(scale * scene.height))};
  return size.width < 24 || size.height < 16 ? vision::Size{} : size;
}

void mark_place(vision::View<std::uint32_t> picture, const InsetPlace& place, double line) {
  for (int y = 0; y < picture.height; ++y) {
    const double inner_row = share(y, place.top, place.bottom),
                 outer_row = share(y, place.top - line, place.bottom + line);
    std::uint32_t* row = picture.row(y);
    for (int x = 0; x < picture.width; ++x) {
      const double inner = inner_row * share(x, place.left, place.right);
      const double outer = outer_row * share(x, place.left - line, place.right + line);
      const double kept = inner + (1 - outer) * kInsetDimming, white = 255 * (outer - inner);
      std::uint32_t word = 0xff000000u;
      for (int shift = 0; shift < 24; shift += 8) {
        const double color = kept * ((row[x] >> shift) & 0xffu) + white;
        word |= static_cast<std::uint32_t>(std::lround(color)) << shift;
      }
      row[x] = word;
    }
  }
}

}  // namespace cerberus::overlay
