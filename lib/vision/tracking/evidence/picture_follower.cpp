// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/evidence/picture_follower.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "vision/tracking/evidence/sparse_flow.h"

namespace cerberus::vision {

namespace {

// Points in the central half of the box's width, from head to knee: the rest is mostly background.
constexpr int kColumns = 5, kRows = 8, kPoints = kColumns * kRows;
constexpr double kLeft = 0.25, kWide = 0.5, kTop = 0.08, kHigh = 0.72;
constexpr int kFewest = 10;      // points that come back
constexpr double kReturn = 0.5;  // pixels, or a hundredth of the height, within which they do
constexpr double kReturnShare = 0.01;
constexpr double kFarApart = 0.15;    // of the height: distances that tell the size
constexpr double kMostGrowth = 1.03;  // from frame to frame

double median(std::span<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<BoxStep> follow_box(const Pyramid& before, const Pyramid& now, const Box& box,
                                  const Point& guess) {
  std::array<Point, kPoints> from, to;
  std::size_t n = 0;
  const double slack = std::max(kReturn, kReturnShare * box.height);
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      const Point at{box.x + box.width * (kLeft + kWide * (column + .5) / kColumns),
                     box.y + box.height * (kTop + kHigh * (row + .5) / kRows)};
      const auto there = follow_point(before, now, at, {at.x + guess.x, at.y + guess.y});
      if (!there) continue;
      const auto back = follow_point(now, before, *there, at);
      if (!back || std::hypot(back->x - at.x, back->y - at.y) >= slack) continue;
      from[n] = at, to[n] = *there, ++n;
    }
  if (n < kFewest) return std::nullopt;
  std::array<double, kPoints> across, down;
  for (std::size_t i = 0; i < n; ++i) across[i] = to[i].x - from[i].x, down[i] = to[i].y - from[i].y;
  BoxStep step{{median({across.data(), n}), median({down.data(), n})}};
  std::array<double, kPoints*(kPoints - 1) / 2> ratios;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const double was = std::hypot(from[i].x - from[j].x, from[i].y - from[j].y);
      if (was > kFarApart * box.height)
        ratios[pairs++] = std::hypot(to[i].x - to[j].x, to[i].y - to[j].y) / was;
    }
  if (pairs > 0) step.growth = std::clamp(median({ratios.data(), pairs}), 1 / kMostGrowth, kMostGrowth);
  return step;
}

}  // namespace cerberus::vision
