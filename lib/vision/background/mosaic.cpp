// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/background/mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "vision/image/preallocate.h"
#include "vision/image/shift_content.h"

namespace cerberus::vision {
namespace {

constexpr int kCell = Mosaic::kCell, kQuarter = kCell / 2;
constexpr double kWide = 2.5, kHigh = 1.25;  // of the mosaic, in pictures
constexpr int kSlack = 4;                    // cells the mosaic follows the picture by, beyond what it must
// How much larger or smaller than the picture shows it the mosaic may hold something: 2 is 37 degrees from where it
// began, for a camera that turns.
constexpr double kMagnification = 2;
// Grey levels by which a pixel is darker or brighter, more than most noise and details make, and the share of what came
// back that must be: people who fill the edge of the picture are less, mostly.
constexpr int kDifferent = 6;
constexpr double kMost = 0.75;

// Only what leaves and enters matters for a shift by whole pixels; a transform may uncover anything.
bool is_shift(const Transform& t) {
  return t.is_affine() && t.m[0] == 1 && t.m[1] == 0 && t.m[3] == 0 && t.m[4] == 1;
}

// A cell's or a quarter's first pixel from its middle.
int first_of(double middle, int side) {
  return static_cast<int>(std::lround(middle - (side - 1) / 2.0));
}

bool is_inside(int left, int top, Size picture) {
  return left >= 0 && top >= 0 && left + kCell <= picture.width && top + kCell <= picture.height;
}

}  // namespace

template <typename F>
void Mosaic::for_each_uncovered(const Transform& motion, Size size, F&& f) {
  if (!is_shift(motion)) {
    f(Part{0, 0, size.width, size.height});
    return;
  }
  const int dx = static_cast<int>(std::lround(std::clamp<double>(motion.m[2], -size.width, size.width)));
  const int dy = static_cast<int>(std::lround(std::clamp<double>(motion.m[5], -size.height, size.height)));
  if (dx > 0) f(Part{0, 0, dx, size.height});
  if (dx < 0) f(Part{size.width + dx, 0, size.width, size.height});
  if (dy > 0) f(Part{0, 0, size.width, dy});
  if (dy < 0) f(Part{0, size.height + dy, size.width, size.height});
}

void Mosaic::preallocate(Size picture) {
  columns_ = static_cast<int>(std::ceil(kWide * picture.width / kCell));
  rows_ = static_cast<int>(std::ceil(kHigh * picture.height / kCell));
  vision::preallocate(cells_, static_cast<std::size_t>(columns_) * rows_);
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  begin(picture);
}

void Mosaic::begin(Size picture) {
  if (!empty_) std::ranges::fill(cells_, Cell{});
  empty_ = true;
  last_ = {};
  // The picture in the middle, its corner on a cell's.
  const auto middle = [](int cells, int side) { return (cells * kCell - side) / 2 / kCell * kCell; };
  place_ = Transform::translation(middle(columns_, picture.width), middle(rows_, picture.height));
}

void Mosaic::keep(const BackgroundPixels& pixels, const Transform& next) {
  const Size size = pixels.age.size();
  // What is uncovered on the way back is what leaves.
  for_each_uncovered(next.inverse(), size, [&](const Part& part) { keep_part(pixels, next, part); });
}

void Mosaic::keep_part(const BackgroundPixels& pixels, const Transform& next, const Part& part) {
  const Size size = pixels.age.size();
  // The part's extent in the mosaic.
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (const int x : {part.left, part.right - 1})
    for (const int y : {part.top, part.bottom - 1}) {
      const Point p = place_.apply({static_cast<double>(x), static_cast<double>(y)});
      left = std::min(left, p.x), right = std::max(right, p.x);
      top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    }
  const auto cell_of = [](double at, int count) {
    return static_cast<int>(std::clamp<double>(std::floor(at / kCell), -1, count));
  };
  const Transform here = place_.inverse();
  for (int row = std::max(cell_of(top, rows_), 0); row <= std::min(cell_of(bottom, rows_), rows_ - 1); ++row)
    for (int column = std::max(cell_of(left, columns_), 0);
         column <= std::min(cell_of(right, columns_), columns_ - 1); ++column) {
      const Point now = here.apply({kCell * column + (kCell - 1) / 2.0, kCell * row + (kCell - 1) / 2.0});
      const int x = first_of(now.x, kCell), y = first_of(now.y, kCell);
      if (!is_inside(x, y, size)) continue;
      const Point then = next.apply(now);
      if (is_inside(first_of(then.x, kCell), first_of(then.y, kCell), size)) continue;
      const Cell cell = summary(pixels, x, y);
      if (cell.age == 0) continue;
      cells().at(column, row) = cell;
      empty_ = false;
    }
}

Mosaic::Cell Mosaic::summary(const BackgroundPixels& pixels, int left, int top) {
  Cell cell;
  int age = kOldest, spread = 0;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const int x0 = left + quarter % 2 * kQuarter, y0 = top + quarter / 2 * kQuarter;
    int sum = 0;
    for (int y = y0; y < y0 + kQuarter; ++y)
      for (int x = x0; x < x0 + kQuarter; ++x) {
        sum += pixels.mean.at(x, y);
        age = std::min<int>(age, pixels.age.at(x, y));
      }
    const int mean = sum / (kQuarter * kQuarter);
    for (int y = y0; y < y0 + kQuarter; ++y)
      for (int x = x0; x < x0 + kQuarter; ++x)
        spread = std::max(
            {spread, static_cast<int>(pixels.spread.at(x, y)), std::abs(pixels.mean.at(x, y) - mean) >> 4});
    cell.mean[quarter] = static_cast<std::uint8_t>(std::min(mean + 128, 255 << 8) >> 8);
  }
  cell.spread = static_cast<std::uint8_t>(std::min(spread, 255));
  cell.age = static_cast<std::uint8_t>(age);
  return cell;
}

void Mosaic::recall(const BackgroundPixels& pixels, const Transform& next) {
  const Size size = pixels.age.size();
  place_ = place_ * next.inverse();
  follow(size);
  if (empty_) return;
  for_each_uncovered(next, size, [&](const Part& part) { recall_part(pixels, part); });
  last_ = next;
}

void Mosaic::doubt(const BackgroundPixels& pixels, GrayView present, GrayView memory,
                   std::span<const RowSpan> shown) {
  if (last_.is_identity()) return;
  const auto for_each_recalled = [&](int step, auto&& f) {
    for_each_uncovered(last_, pixels.age.size(), [&](const Part& part) {
      for (int y = part.top; y < part.bottom; y += step) {
        const std::uint8_t *age = pixels.age.row(y), *quiet = pixels.quiet.row(y);
        for (int x = part.left; x < part.right; x += step)
          if (quiet[x] == 0 && age[x] > 0 && age[x] <= kOldest) f(x, y);
      }
    });
  };
  long count = 0, darker = 0, brighter = 0;
  for_each_recalled(2, [&](int x, int y) {
    const RowSpan span = shown[static_cast<std::size_t>(y)];
    if (x < span.begin || x >= span.end) return;
    const int e = present.at(x, y) - memory.at(x, y);
    ++count;
    darker += e < -kDifferent;
    brighter += e > kDifferent;
  });
  if (static_cast<double>(std::max(darker, brighter)) > kMost * static_cast<double>(count))
    for_each_recalled(1, [&](int x, int y) { pixels.age.at(x, y) = 0; });
  last_ = {};
}

void Mosaic::recall_part(const BackgroundPixels& pixels, const Part& part) {
  const int width = columns_ * kCell, height = rows_ * kCell;
  const auto& m = place_.m;
  const bool affine = place_.is_affine();
  for (int y = part.top; y < part.bottom; ++y) {
    const double u0 = m[1] * y + m[2] + 0.5, v0 = m[4] * y + m[5] + 0.5, w0 = m[7] * y + m[8];
    std::uint8_t* age = pixels.age.row(y);
    for (int x = part.left; x < part.right; ++x) {
      const void* unknown = std::memchr(age + x, 0, static_cast<std::size_t>(part.right - x));
      if (!unknown) break;
      x = static_cast<int>(static_cast<const std::uint8_t*>(unknown) - age);
      double u = u0 + m[0] * x, v = v0 + m[3] * x;
      if (!affine) {
        const double w = 1 / (w0 + m[6] * x);
        u = (u - 0.5) * w + 0.5, v = (v - 0.5) * w + 0.5;
      }
      if (!(u >= 0 && v >= 0 && u < width && v < height)) continue;
      const int column = static_cast<int>(u), row = static_cast<int>(v);  // to the nearest pixel
      const Cell& cell = cells().at(column / kCell, row / kCell);
      if (cell.age == 0) continue;
      const int quarter = row % kCell / kQuarter * 2 + column % kCell / kQuarter;
      pixels.mean.at(x, y) = static_cast<std::uint16_t>(cell.mean[quarter] << 8);
      pixels.spread.at(x, y) = cell.spread;
      pixels.quiet.at(x, y) = 0;
      age[x] = cell.age;
    }
  }
}

// The mosaic goes along with a picture that leaves it, by whole cells.
void Mosaic::follow(Size picture) {
  const double right = picture.width - 1.0, bottom = picture.height - 1.0;
  double left_most = 1e9, top_most = 1e9, right_most = -1e9, bottom_most = -1e9;
  for (const Point corner : {Point{0, 0}, Point{right, 0}, Point{0, bottom}, Point{right, bottom}}) {
    const Point p = place_.apply(corner);
    left_most = std::min(left_most, p.x), right_most = std::max(right_most, p.x);
    top_most = std::min(top_most, p.y), bottom_most = std::max(bottom_most, p.y);
  }
  const double width = right_most - left_most, height = bottom_most - top_most;
  const bool alike = place_.is_sane(picture) && width < kMagnification * right &&
                     height < kMagnification * bottom && kMagnification * width > right &&
                     kMagnification * height > bottom;
  if (!alike) {
    begin(picture);
    return;
  }
  // By how many cells the content has to move for the picture to lie inside; where it is too large for that, in the
  // middle.
  const auto cells_to_go = [](double low, double high, int count) {
    const double over = high - (count * kCell - 1);
    if (low < 0 && over > 0)
      return std::abs(low + over) > 2 * kSlack * kCell ? static_cast<int>(-(low + over) / 2 / kCell) : 0;
    if (low < 0) return static_cast<int>(std::ceil(-low / kCell)) + kSlack;
    return over > 0 ? -static_cast<int>(std::ceil(over / kCell)) - kSlack : 0;
  };
  const int dx = cells_to_go(left_most, right_most, columns_), dy = cells_to_go(top_most, bottom_most, rows_);
  if (dx == 0 && dy == 0) return;
  shift_content(cells(), dx, dy, Cell{});
  place_ = Transform::translation(kCell * dx, kCell * dy) * place_;
}

void Mosaic::relight(int gain, int offset) {
  for (Cell& cell : cells_)
    for (std::uint8_t& mean : cell.mean)
      mean = static_cast<std::uint8_t>(std::clamp(mean * gain + offset + 128, 0, 255 << 8) >> 8);
}

}  // namespace cerberus::vision
