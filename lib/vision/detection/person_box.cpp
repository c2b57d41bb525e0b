// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/person_box.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace cerberus::vision {
namespace {

constexpr int kMostColumns = 2048;  // around an axis: a body of 3200 pixels has as many
constexpr int kMostLegRows = 64;    // samples of the legs' width

struct Interval {
  int from = 0, to = 0;
};
Interval around(double axis, double reach, const Bounds& window) {
  const int from = std::clamp(static_cast<int>(axis - reach), window.left, window.right);
  return {from, std::clamp(static_cast<int>(axis + reach) + 1, from, window.right)};
}

int count(BitView moving, int row, Interval columns) {
  int n = 0;
  for_words(columns.from, columns.to,
            [&](int word, std::uint64_t ones) { n += std::popcount(moving.row(row)[word] & ones); });
  return n;
}

// Returns whether a pixel is in the box of another person and nearer to the axis of that one.
bool is_others(int x, int y, std::size_t self, std::span<const Person> all) {
  const auto off = [x](const Box& b) { return std::abs(x - b.x - b.width / 2); };
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Box& b = all[k].box;
    if (k != self && x >= b.x && x < b.right() && y >= b.y && y < b.bottom() && off(b) < off(all[self].box))
      return true;
  }
  return false;
}

// The foreground around an axis that belongs to one person, by columns.
struct Columns {
  std::array<std::uint16_t, kMostColumns> filled, changed;  // pixels; changed: since the frame before
  Interval range;
  std::uint16_t filled_at(int x) const { return filled[static_cast<std::size_t>(x - range.from)]; }
  std::uint16_t changed_at(int x) const { return changed[static_cast<std::size_t>(x - range.from)]; }
};

Columns columns_of(BitView moving, const Change& change, const Bounds& window, std::size_t self,
                   std::span<const Person> all, const PersonBoxParameters& q, Interval range) {
  const Box& body = all[self].box;
  Columns columns;
  columns.range = range;
  std::fill_n(columns.filled.begin(), range.to - range.from, std::uint16_t{0});
  std::fill_n(columns.changed.begin(), range.to - range.from, std::uint16_t{0});
  const int top = std::max(window.top, static_cast<int>(body.y + q.below_head * body.height));
  const int bottom = std::min(window.bottom, static_cast<int>(body.y + q.above_feet * body.height));
  for (int y = top; y < bottom; ++y)
    for_bits(moving.row(y), range.from, range.to, [&](int x) {
      if (all.size() > 1 && is_others(x, y, self, all)) return;
      const auto i = static_cast<std::size_t>(x - range.from);
      ++columns.filled[i];
      columns.changed[i] += change.at(x, y);
    });
  return columns;
}

// Without the outermost columns that rest, where the body does not.
Interval without_resting(Interval sides, const Columns& columns, double axis, double height,
                         const PersonBoxParameters& q) {
  long filled = 0, changed = 0;
  for (int x = sides.from; x < sides.to; ++x) {
    filled += columns.filled_at(x);
    changed += columns.changed_at(x);
  }
  if (static_cast<double>(changed) < q.changes * static_cast<double>(filled)) return sides;
  const auto rests = [&](int x) { return columns.changed_at(x) < q.rests * columns.filled_at(x); };
  while (sides.from < sides.to && sides.from < axis - q.trunk * height && rests(sides.from)) ++sides.from;
  while (sides.to > sides.from && sides.to > axis + q.trunk * height && rests(sides.to - 1)) --sides.to;
  return sides;
}

Interval sides(BitView moving, const Change& change, const Bounds& window, std::size_t self,
               std::span<const Person> all, const PersonBoxParameters& q) {
  const Box& body = all[self].box;
  const double h = body.height, axis = body.x + body.width / 2;
  Interval range = around(axis, q.reach * h, window);
  range.to = std::min(range.to, range.from + kMostColumns);
  if (range.from >= range.to) return {};
  const Columns columns = columns_of(moving, change, window, self, all, q, range);
  const auto is_full = [&](int x) { return columns.filled_at(x) >= q.column * h; };
  Interval full;
  full.from = full.to = std::clamp(static_cast<int>(axis), range.from, range.to - 1);
  while (full.from > range.from && is_full(full.from - 1)) --full.from;
  while (full.to + 1 < range.to && is_full(full.to + 1)) ++full.to;
  ++full.to;
  return without_resting(full, columns, axis, h, q);
}

// The first row of the head; the expected one where there is no foreground.
double head(BitView moving, const Bounds& window, const Box& body, const PersonBoxParameters& q) {
  const double h = body.height;
  const Interval columns = around(body.x + body.width / 2, q.head_reach * h, window);
  const int end = std::min(window.bottom, static_cast<int>(body.y + q.head_fall * h));
  for (int y = std::max(window.top, static_cast<int>(body.y - q.head_rise * h)); y < end; ++y)
    if (count(moving, y, columns) >= std::max(1.0, q.head_row * h)) return y;
  return body.y;
}

// The row behind the feet, where no shadow is.
int ground(BitView moving, const Bounds& window, const Box& body, const PersonBoxParameters& q) {
  const double h = body.height;
  const Interval columns = around(body.x + body.width / 2, q.leg_reach * h, window);
  int y = std::min(window.bottom, static_cast<int>(std::ceil(body.bottom() + q.foot_fall * h))) - 1;
  while (y > std::max<double>(window.top, body.y + q.legs_to * h) &&
         count(moving, y, columns) < std::max(1.0, q.foot_row * h))
    --y;
  return y + 1;
}

// The row behind the feet of a body that takes the rows [top, bottom) with its shadow.
double foot(BitView moving, const Bounds& window, Interval columns, int top, int bottom,
            const PersonBoxParameters& q) {
  const int height = bottom - top;
  const auto filled = [&](int y) {
    return y >= window.top && y < window.bottom ? count(moving, y, columns) : 0;
  };
  std::array<int, kMostLegRows> legs;
  std::size_t n = 0;
  const int step = 1 + height / (3 * kMostLegRows);
  for (int y = top + static_cast<int>(q.legs_from * height); y < top + static_cast<int>(q.legs_to * height);
       y += step)
    if (n < legs.size()) legs[n++] = filled(y);
  if (n == 0) return bottom;
  std::nth_element(legs.begin(), legs.begin() + n / 2, legs.begin() + n);
  const double wide = q.shadow_wide * legs[n / 2];
  int shadow = bottom;  // its first row
  for (int y = bottom - 1; y >= top + static_cast<int>(q.shadow_from * height); --y) {
    if (filled(y) > wide)
      shadow = y;
    else if (shadow < bottom || bottom - y > q.shadow_tip * height)
      break;
  }
  return shadow < bottom ? (shadow + bottom + 1) / 2 : bottom;
}

// Share of the rectangle that is foreground: columns from `from` to `to`, rows [top, bottom). Nothing moves outside the
// picture.
double share(BitView moving, Size picture, double from, double to, int top, int bottom) {
  const int left = std::clamp(static_cast<int>(std::lround(from)), 0, picture.width);
  const int right = std::clamp(static_cast<int>(std::lround(to)), left, picture.width);
  int n = 0;
  for (int y = std::max(0, top); y < std::min(bottom, picture.height); ++y)
    n += count(moving, y, {left, right});
  const int pixels = std::max(1, right - left) * std::max(1, bottom - top);
  return static_cast<double>(n) / pixels;
}

}  // namespace

bool has_free_head(BitView moving, Size picture, const Box& body, const FreeHeadParameters& q) {
  const double h = body.height, axis = body.x + body.width / 2;
  const int top = static_cast<int>(std::lround(body.y)),
            bottom = static_cast<int>(std::lround(body.y + q.rows * h));
  const auto beside = [&](double from, double to) {
    return share(moving, picture, axis + from * h, axis + to * h, top, bottom);
  };
  return top >= 0 && beside(-q.core, q.core) > q.least_core &&
         (beside(-q.beside_to, -q.beside_from) + beside(q.beside_from, q.beside_to)) / 2 < q.most_beside;
}

Box fit_box(BitView moving, const Change& change, const Bounds& window, std::size_t self,
            std::span<const Person> all, const PersonBoxParameters& q) {
  const Box& body = all[self].box;
  const double h = body.height, axis = body.x + body.width / 2;
  const Interval full = sides(moving, change, window, self, all, q);
  if (full.from >= full.to) return body;
  const double top = head(moving, window, body, q);
  const double bottom = foot(moving, window, around(axis, q.shadow_reach * h, window), static_cast<int>(top),
                             ground(moving, window, body, q), q);
  const auto between = [&](double expected, double seen) {
    return expected + q.measured * (seen - expected);
  };
  const double x0 = between(axis - q.aspect * h / 2, full.from),
               x1 = between(axis + q.aspect * h / 2, full.to);
  const double y0 = between(body.y, top), y1 = between(body.bottom(), bottom);
  return {x0, y0, x1 - x0, y1 - y0};
}

}  // namespace cerberus::vision
