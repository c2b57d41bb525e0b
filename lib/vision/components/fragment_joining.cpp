// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/fragment_joining.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cerberus::vision {
namespace {

// Origin unknown where none is given: kept from the first version. Guard of all: unit-fragment_joining and mean F of
// bench-quality.
constexpr struct Parameters {
  double common = 0.6;   // share of the wider one's columns that both have
  double tallest = 4.5;  // height of a person over his width, at most
  int contrast = 6;      // grey levels of an edge: the comparison's limit for noise
  int slack = 2;         // pixels to either side in which a side is searched
  // Along the side of an object the contrast keeps its sign. Gravel has edges in every row, too, but their sign changes
  // from grain to grain: two rows further apart than a side is searched agree on both sides in a quarter of the cases.
  // Those of an object agree in more than half, also where the background behind it changes.
  double agreement = 0.5;
} kParameters;

// The signed contrast of the strongest edge of the frame near this column, grey levels; 0: there is none.
int side_at(GrayView frame, int x, int y) {
  int most = 0;
  for (int at = x - kParameters.slack; at <= x + kParameters.slack; at += kParameters.slack) {
    if (at < 2 || at + 2 >= frame.width) continue;
    const int step = frame.at(at + 2, y) - frame.at(at - 2, y);
    if (std::abs(step) > std::abs(most)) most = step;
  }
  return std::abs(most) > kParameters.contrast ? most : 0;
}

}  // namespace

void join_fragments(GrayView frame, std::span<const Component> components, MutableBitView mask) {
  for (const Component& a : components)
    for (const Component& b : components) {
      const int rows = b.top - a.bottom, wider = std::max(a.width(), b.width());
      if (rows <= 0 || -gap(a.left, a.right, b.left, b.right) < kParameters.common * wider ||
          b.bottom - a.top > kParameters.tallest * wider)
        continue;
      const auto between = [&](int from, int to, int y) {
        return static_cast<int>(std::lround(from + (to - from) * (y - a.bottom + 0.5) / rows));
      };
      const auto left = [&](int y) { return side_at(frame, between(a.left, b.left, y), y); };
      const auto right = [&](int y) { return side_at(frame, between(a.right, b.right, y), y); };
      const int lag = std::min(2 * kParameters.slack, rows / 2);
      int kept = 0;
      for (int y = a.bottom; y + lag < b.top; ++y)
        kept += left(y) * left(y + lag) > 0 && right(y) * right(y + lag) > 0;
      if (kept < kParameters.agreement * (rows - lag)) continue;
      for (int y = a.bottom; y < b.top; ++y)
        set_bits(mask.row(y), between(a.left, b.left, y), between(a.right, b.right, y));
    }
}

}  // namespace cerberus::vision
