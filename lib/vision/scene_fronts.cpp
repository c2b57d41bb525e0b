// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/scene_fronts.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cerberus::vision {
namespace {

constexpr double kCommon = 0.6;  // share of the wider one's columns that both have
constexpr double kLean = 4.5;    // nobody is so many times as tall as wide
constexpr int kEdge = 6;         // grey levels of contrast: what is noise to the comparison is so here
constexpr int kSlack = 2;        // pixels to either side in which a side is looked for
constexpr double kSides = 0.6;   // share of the rows that have both sides

// Is there an edge of the frame at about this column?
bool has_side(GrayView frame, int x, int y) {
  for (int at = x - kSlack; at <= x + kSlack; at += kSlack) {
    if (at < 2 || at + 2 >= frame.width) continue;
    if (std::abs(frame.at(at - 2, y) - frame.at(at + 2, y)) > kEdge) return true;
  }
  return false;
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
      int seen = 0;
      for (int y = a.bottom; y < b.top; ++y)
        seen += has_side(frame, between(a.left, b.left, y), y) &&
                has_side(frame, between(a.right, b.right, y), y);
      if (seen < kSides * rows) continue;
      for (int y = a.bottom; y < b.top; ++y)
        set_bits(mask.row(y), between(a.left, b.left, y), between(a.right, b.right, y));
    }
}

}  // namespace cerberus::vision
