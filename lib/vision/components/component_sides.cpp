// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/component_sides.h"

#include <algorithm>
#include <cstdlib>

#include "vision/components/outline_contrast.h"

namespace cerberus::vision {
namespace {

// Guard of all: the cases of unit-components and unit-steady (streets after a cut), mean F of bench-quality.
constexpr struct Parameters {
  int visible_difference = 12;  // grey levels by which a pixel certainly differs from the background
  double uneven = 0.25;         // share of a gap's pixels that may differ so much from their neighbours
  // Rows beyond a component in which its sides may go on: of its height, and at least.
  double reach = 0.25;
  int least_reach = 4;
  double goes_on = 0.5;  // of a side's contrast that an edge which goes on has
} kParameters;

// Contrast across a side, in the rows in which it can be compared.
struct Contrast {
  int sum = 0, rows = 0;  // grey levels

  // Across column x; the component lies to the left of a right side.
  static bool is_comparable(RowSpan visible, int x) { return x >= visible.begin + 2 && x + 2 <= visible.end; }
  void add(GrayView picture, const VisibleColumns& visible, int x, int y, bool right) {
    if (!is_comparable(visible.of(y), x)) return;
    sum += std::abs(picture.at(right ? x + 1 : x - 2, y) - picture.at(right ? x - 2 : x + 1, y));
    ++rows;
  }
  double mean() const { return rows > 0 ? static_cast<double>(sum) / rows : 0; }
};

// Calls look(row, column) for each of these rows that the component has: the first column beyond its outermost run on the
// right, or the first one of that on the left.
template <typename Look>
void for_outermost(std::span<const Run> runs, std::size_t component, bool right, const Rows& rows,
                   const Look& look) {
  int row = -1, side = 0;  // of the runs so far; runs are in reading order
  for (const Run& r : runs) {
    if (r.component != component || r.row < rows.top || r.row >= rows.bottom) continue;
    if (r.row != row && row >= 0) look(row, side);
    if (r.row != row || right) side = right ? r.end : r.first;
    row = r.row;
  }
  if (row >= 0) look(row, side);
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

bool is_side_of_object(GrayView frame, GrayView background, const VisibleColumns& visible,
                       std::span<const Run> runs, std::size_t component, bool right, const Rows& rows) {
  OutlineContrast contrast;
  for_outermost(runs, component, right, rows, [&](int y, int x) {
    if (Contrast::is_comparable(visible.of(y), x))
      contrast.add(frame, background, y, right ? x + 1 : x - 2, right ? x - 2 : x + 1);
  });
  return contrast.is_side_of_object();
}

bool sides_go_on(GrayView frame, const VisibleColumns& visible, BitView mask, std::span<const Run> runs,
                 std::size_t component) {
  const Parameters& p = kParameters;
  const auto goes_on = [&](bool right) {
    Contrast side;
    int top = -1, bottom = 0, first_column = 0, last_column = 0;  // where the side begins and ends
    for_outermost(runs, component, right, {0, frame.height}, [&](int y, int x) {
      side.add(frame, visible, x, y, right);
      if (top < 0) top = y, first_column = x;
      bottom = y + 1, last_column = x;
    });
    if (side.sum == 0) return false;
    const int reach = std::max(p.least_reach, static_cast<int>(p.reach * (bottom - top)));
    const auto is_edge = [&](int x, int from, int to) {
      Contrast beyond;
      for (int y = std::max(from, 0); y < std::min(to, frame.height); ++y)
        if (x < frame.width && !bit_at(mask.row(y), x)) beyond.add(frame, visible, x, y, right);
      return beyond.rows > 0 && beyond.mean() >= p.goes_on * side.mean();
    };
    return is_edge(first_column, top - reach, top) || is_edge(last_column, bottom, bottom + reach);
  };
  return goes_on(false) && goes_on(true);
}

}  // namespace cerberus::vision
