// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/component_fronts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cerberus::vision {
namespace {

constexpr double kCommon = 0.6;  // share of the wider one's columns that both have
constexpr double kLean = 4.5;    // nobody is so many times as tall as wide
constexpr int kEdge = 6;         // grey levels of contrast: what is noise to the comparison is so here
constexpr int kSlack = 2;        // pixels to either side in which a side is looked for
// Beside a thing it is brighter, or darker, all along. Gravel has edges in every row, too, but which way they go
// changes from grain to grain: of rows as far apart as a side is looked for, both go the same way in a quarter. Of a
// thing's it is more than half, also where one scene ends behind it and another begins.
constexpr int kGrain = 2 * kSlack;
constexpr double kSides = 0.5;

// Which way, and by how much, the brightness goes at an edge of the frame at about this column; 0: there is none.
int side_at(GrayView frame, int x, int y) {
  int most = 0;
  for (int at = x - kSlack; at <= x + kSlack; at += kSlack) {
    if (at < 2 || at + 2 >= frame.width) continue;
    const int step = frame.at(at + 2, y) - frame.at(at - 2, y);
    if (std::abs(step) > std::abs(most)) most = step;
  }
  return std::abs(most) > kEdge ? most : 0;
}

}  // namespace

void join_fronts(GrayView frame, std::span<const Component> parts, MutableBitView mask) {
  for (const Component& a : parts)
    for (const Component& b : parts) {
      const int rows = b.top - a.bottom, wider = std::max(a.width(), b.width());
      if (rows <= 0 || -gap(a.left, a.right, b.left, b.right) < kCommon * wider ||
          b.bottom - a.top > kLean * wider)
        continue;
      const auto between = [&](int from, int to, int y) {
        return static_cast<int>(std::lround(from + (to - from) * (y - a.bottom + 0.5) / rows));
      };
      const auto left = [&](int y) { return side_at(frame, between(a.left, b.left, y), y); };
      const auto right = [&](int y) { return side_at(frame, between(a.right, b.right, y), y); };
      const int lag = std::min(kGrain, rows / 2);
      int kept = 0;
      for (int y = a.bottom; y + lag < b.top; ++y)
        kept += left(y) * left(y + lag) > 0 && right(y) * right(y + lag) > 0;
      if (kept < kSides * (rows - lag)) continue;
      for (int y = a.bottom; y < b.top; ++y)
        set_bits(mask.row(y), between(a.left, b.left, y), between(a.right, b.right, y));
    }
}

}  // namespace cerberus::vision
