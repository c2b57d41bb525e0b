// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/component_sides.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace cerberus::vision {
namespace {

// Guard of all: the cases of unit-components and unit-steady (streets after a cut), mean F of bench-quality.
constexpr struct Parameters {
  int visible_difference = 12;  // grey levels by which a pixel certainly differs from the background
  double uneven = 0.25;         // share of a gap's pixels that may differ so much from their neighbours
  // Times as much contrast in the frame as in the background, and grey levels a pixel more, at the side of an object. The
  // ratio is that of components.cpp. swept: with a margin of 2 unit-steady finds strips that people leave; with 6 the
  // recall on TUD-Stadtmitte is .24 instead of .25.
  double side_ratio = 1.3, side_margin = 4;
  // Rows beyond a component in which its sides may go on: of its height, and at least.
  double reach = 0.25;
  int least_reach = 4;
  double goes_on = 0.5;  // of a side's contrast that an edge which goes on has
} kParameters;

// The contrast across column x, grey levels; the component lies to the left of a right side.
int across(GrayView picture, int x, int y, bool right) {
  const int out = right ? x + 1 : x - 2, in = right ? x - 2 : x + 1;
  if (std::min(out, in) < 0 || std::max(out, in) >= picture.width) return 0;
  return std::abs(picture.at(out, y) - picture.at(in, y));
}

}  // namespace

bool is_even(GrayView frame, const Gap& gap, int moved) {
  const int step = std::max(std::min(moved, (gap.right - gap.left) / 2), 1);
  int uneven = 0, seen = 0;
  for (int y = gap.top; y < gap.bottom; ++y)
    for (int x = gap.left; x + step < gap.right; ++x) {
      ++seen;
      uneven += std::abs(frame.at(x + step, y) - frame.at(x, y)) > kParameters.visible_difference;
    }
  return uneven <= kParameters.uneven * seen;
}

bool is_side_of_object(GrayView frame, GrayView background, std::span<const Run> runs, std::size_t component,
                       bool right, const Rows& rows) {
  int in_frame = 0, in_background = 0, places = 0;
  const auto look = [&](int y, int side) {  // side: the first column beyond the component, or its first one
    if (side < 2 || side + 2 > frame.width) return;
    in_frame += across(frame, side, y, right);
    in_background += across(background, side, y, right);
    ++places;
  };
  int row = -1, side = 0;  // of the runs so far; runs are in reading order
  for (const Run& r : runs) {
    if (r.component != component || r.row < rows.top || r.row >= rows.bottom) continue;
    if (r.row != row && row >= 0) look(row, side);
    if (r.row != row || right) side = right ? r.end : r.first;
    row = r.row;
  }
  if (row >= 0) look(row, side);
  return in_frame >= kParameters.side_ratio * in_background + kParameters.side_margin * places;
}

bool sides_go_on(GrayView frame, BitView mask, std::span<const Run> runs, std::size_t component) {
  const Parameters& p = kParameters;
  struct Side {
    int contrast = 0, top = 0, bottom = 0;  // sum of grey levels; columns where it begins and ends
  };
  std::array<Side, 2> sides;
  int top = -1, bottom = 0;
  for (const Run& r : runs) {
    if (r.component != component) continue;
    for (const bool right : {false, true}) {
      Side& side = sides[right];
      side.bottom = right ? r.end : r.first;
      if (top < 0) side.top = side.bottom;
      side.contrast += across(frame, side.bottom, r.row, right);
    }
    if (top < 0) top = r.row;
    bottom = r.row + 1;
  }
  const int reach = std::max(p.least_reach, static_cast<int>(p.reach * (bottom - top)));
  const auto contrast = [&](int x, int from, int to, bool right) {
    int sum = 0, rows = 0;
    for (int y = std::max(from, 0); y < std::min(to, frame.height); ++y) {
      if (x >= frame.width || mask.row(y)[x / 64] >> (x % 64) & 1) continue;
      sum += across(frame, x, y, right);
      ++rows;
    }
    return rows > 0 ? static_cast<double>(sum) / rows : 0.0;
  };
  const auto goes_on = [&](bool right) {
    const Side& side = sides[right];
    const double least = p.goes_on * side.contrast / std::max(bottom - top, 1);
    return contrast(side.top, top - reach, top, right) >= least ||
           contrast(side.bottom, bottom, bottom + reach, right) >= least;
  };
  return goes_on(false) && goes_on(true);
}

}  // namespace cerberus::vision
