// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/patch_matching.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace cerberus::vision {

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
constexpr int kFewest = 16;  // pixels that are compared, at least

struct Area {
  int left, top, right, bottom;
};

// Mean absolute difference between `a` in `before` and the same area, displaced, in `now`, over what both pictures
// show.
double mean_difference(GrayView before, GrayView now, const Area& a, int dx, int dy, int most = 255) {
  const int left = std::max(a.left, -dx), right = std::min(a.right, now.width - dx);
  const int top = std::max(a.top, -dy), bottom = std::min(a.bottom, now.height - dy);
  if (right - left < 1 || bottom - top < 1 || (right - left) * (bottom - top) < kFewest) return kNone;
  if (2 * (right - left) * (bottom - top) < (a.right - a.left) * (a.bottom - a.top)) return kNone;
  long sum = 0;
  for (int y = top; y < bottom; ++y) {
    const std::uint8_t *p = before.row(y), *q = now.row(y + dy) + dx;
    int row = 0;
    for (int x = left; x < right; ++x) row += std::min(std::abs(p[x] - q[x]), most);
    sum += row;
  }
  return static_cast<double>(sum) / ((right - left) * (bottom - top));
}

Area area_of(const Box& patch, Size picture) {
  return {std::max(0, static_cast<int>(std::lround(patch.x))),
          std::max(0, static_cast<int>(std::lround(patch.y))),
          std::min(picture.width, static_cast<int>(std::lround(patch.right()))),
          std::min(picture.height, static_cast<int>(std::lround(patch.bottom())))};
}

// Offset of the lowest point of the parabola through three sums one pixel apart.
double vertex(double left, double middle, double right) {
  const double bend = left - 2 * middle + right;
  return std::isfinite(bend) && bend > 0 ? std::clamp((left - right) / (2 * bend), -0.5, 0.5) : 0;
}

}  // namespace

std::optional<double> patch_difference(GrayView before, GrayView now, const Box& patch, Point displaced,
                                       int most) {
  const Area area = area_of(patch, before.size());
  if (area.left >= area.right || area.top >= area.bottom || before.size() != now.size()) return std::nullopt;
  const double mean = mean_difference(before, now, area, static_cast<int>(std::lround(displaced.x)),
                                      static_cast<int>(std::lround(displaced.y)), most);
  return std::isfinite(mean) ? std::optional(mean) : std::nullopt;
}

Point match_patch(GrayView before, GrayView now, const Box& patch, Point guess, int reach) {
  const Area area = area_of(patch, before.size());
  if (area.left >= area.right || area.top >= area.bottom || before.size() != now.size()) return guess;
  const int x0 = static_cast<int>(std::lround(guess.x)), y0 = static_cast<int>(std::lround(guess.y));
  int dx = x0, dy = y0;
  double least = mean_difference(before, now, area, x0, y0);
  for (int ring = 1; ring <= reach; ++ring) {
    for (int y = -ring; y <= ring; ++y) {
      const int step = std::abs(y) == ring ? 1 : 2 * ring;
      for (int x = -ring; x <= ring; x += step) {
        const double difference = mean_difference(before, now, area, x0 + x, y0 + y);
        if (difference < least) least = difference, dx = x0 + x, dy = y0 + y;
      }
    }
  }
  if (!std::isfinite(least)) return guess;
  const auto at = [&](int x, int y) { return mean_difference(before, now, area, x, y); };
  return {dx + vertex(at(dx - 1, dy), least, at(dx + 1, dy)),
          dy + vertex(at(dx, dy - 1), least, at(dx, dy + 1))};
}

}  // namespace cerberus::vision
