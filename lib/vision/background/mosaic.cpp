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
// Origin unknown where none is given: kept from the first version. Guard of all: unit-mosaic and the window bench.
constexpr struct Parameters {
  double wide = 2.5, high = 1.25;  // pictures: size of the mosaic
  int slack = 4;                   // cells by which the mosaic follows the picture farther than it must
  // Largest ratio of the scales of mosaic and picture. derived: a camera reaches 2 at 37 degrees from its start.
  double magnification = 2;
  int different = 6;   // grey levels by which a pixel is darker or brighter: more than most noise and details
  double most = 0.75;  // share of the restored pixels that must differ: people at the picture's edge are less
} kParameters;

// A shift by whole pixels uncovers the picture's edges only; another transform may uncover anything.
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
    f(Area{0, 0, size.width, size.height});
    return;
  }
  const int dx = static_cast<int>(std::lround(std::clamp<double>(motion.m[2], -size.width, size.width)));
  const int dy = static_cast<int>(std::lround(std::clamp<double>(motion.m[5], -size.height, size.height)));
  if (dx > 0) f(Area{0, 0, dx, size.height});
  if (dx < 0) f(Area{size.width + dx, 0, size.width, size.height});
  if (dy > 0) f(Area{0, 0, size.width, dy});
  if (dy < 0) f(Area{0, size.height + dy, size.width, size.height});
}

void Mosaic::preallocate(Size picture) {
  columns_ = static_cast<int>(std::ceil(kParameters.wide * picture.width / kCell));
  rows_ = static_cast<int>(std::ceil(kParameters.high * picture.height / kCell));
  vision::preallocate(cells_, static_cast<std::size_t>(columns_) * rows_);
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  reset(picture);
}

void Mosaic::reset(Size picture) {
  if (!empty_) std::ranges::fill(cells_, Cell{});
  empty_ = true;
  restored_ = {};
  // The picture in the middle, its corner on a cell's.
  const auto middle = [](int cells, int side) { return (cells * kCell - side) / 2 / kCell * kCell; };
  to_mosaic_ = Transform::translation(middle(columns_, picture.width), middle(rows_, picture.height));
}

void Mosaic::store(const BackgroundPixels& pixels, const Transform& next) {
  const Size size = pixels.age.size();
  // The areas that the motion back uncovers are those that leave.
  for_each_uncovered(next.inverse(), size, [&](const Area& area) { store_area(pixels, next, area); });
}

void Mosaic::store_area(const BackgroundPixels& pixels, const Transform& next, const Area& area) {
  const Size size = pixels.age.size();
  // The area's extent in the mosaic.
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  for (const int x : {area.left, area.right - 1})
    for (const int y : {area.top, area.bottom - 1}) {
      const Point p = to_mosaic_.apply({static_cast<double>(x), static_cast<double>(y)});
      left = std::min(left, p.x), right = std::max(right, p.x);
      top = std::min(top, p.y), bottom = std::max(bottom, p.y);
    }
  const auto cell_of = [](double at, int count) {
    return static_cast<int>(std::clamp<double>(std::floor(at / kCell), -1, count));
  };
  const Transform here = to_mosaic_.inverse();
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

void Mosaic::restore(const BackgroundPixels& pixels, const Transform& next) {
  const Size size = pixels.age.size();
  to_mosaic_ = to_mosaic_ * next.inverse();
  scroll(size);
  if (empty_) return;
  for_each_uncovered(next, size, [&](const Area& area) { restore_area(pixels, area); });
  restored_ = next;
}

void Mosaic::verify(const BackgroundPixels& pixels, GrayView frame, GrayView background,
                    std::span<const RowSpan> visible) {
  if (restored_.is_identity()) return;
  const auto for_each_restored = [&](int step, auto&& f) {
    for_each_uncovered(restored_, pixels.age.size(), [&](const Area& area) {
      for (int y = area.top; y < area.bottom; y += step) {
        const std::uint8_t *age = pixels.age.row(y), *quiet = pixels.quiet.row(y);
        for (int x = area.left; x < area.right; x += step)
          if (quiet[x] == 0 && age[x] > 0 && age[x] <= kOldest) f(x, y);
      }
    });
  };
  long count = 0, darker = 0, brighter = 0;
  for_each_restored(2, [&](int x, int y) {
    const RowSpan span = visible[static_cast<std::size_t>(y)];
    if (x < span.begin || x >= span.end) return;
    const int e = frame.at(x, y) - background.at(x, y);
    ++count;
    darker += e < -kParameters.different;
    brighter += e > kParameters.different;
  });
  if (static_cast<double>(std::max(darker, brighter)) > kParameters.most * static_cast<double>(count))
    for_each_restored(1, [&](int x, int y) { pixels.age.at(x, y) = 0; });
  restored_ = {};
}

void Mosaic::restore_area(const BackgroundPixels& pixels, const Area& area) {
  const int width = columns_ * kCell, height = rows_ * kCell;
  const auto& m = to_mosaic_.m;
  const bool affine = to_mosaic_.is_affine();
  for (int y = area.top; y < area.bottom; ++y) {
    const double u0 = m[1] * y + m[2] + 0.5, v0 = m[4] * y + m[5] + 0.5, w0 = m[7] * y + m[8];
    std::uint8_t* age = pixels.age.row(y);
    for (int x = area.left; x < area.right; ++x) {
      if (age[x] != 0) {
        const void* unknown = std::memchr(age + x, 0, static_cast<std::size_t>(area.right - x));
        if (!unknown) break;
        x = static_cast<int>(static_cast<const std::uint8_t*>(unknown) - age);
      }
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

// Moves the mosaic by whole cells when the picture leaves it.
void Mosaic::scroll(Size picture) {
  const double right = picture.width - 1.0, bottom = picture.height - 1.0;
  double left_most = 1e9, top_most = 1e9, right_most = -1e9, bottom_most = -1e9;
  for (const Point corner : {Point{0, 0}, Point{right, 0}, Point{0, bottom}, Point{right, bottom}}) {
    const Point p = to_mosaic_.apply(corner);
    left_most = std::min(left_most, p.x), right_most = std::max(right_most, p.x);
    top_most = std::min(top_most, p.y), bottom_most = std::max(bottom_most, p.y);
  }
  const double width = right_most - left_most, height = bottom_most - top_most;
  const bool alike = to_mosaic_.is_sane(picture) && width < kParameters.magnification * right &&
                     height < kParameters.magnification * bottom &&
                     kParameters.magnification * width > right && kParameters.magnification * height > bottom;
  if (!alike) {
    reset(picture);
    return;
  }
  // The number of cells by which the content has to move for the picture to lie inside, or, if the picture is larger,
  // in the middle.
  const auto cells_to_go = [](double low, double high, int count) {
    const double over = high - (count * kCell - 1);
    if (low < 0 && over > 0)
      return std::abs(low + over) > 2 * kParameters.slack * kCell
                 ? static_cast<int>(-(low + over) / 2 / kCell)
                 : 0;
    if (low < 0) return static_cast<int>(std::ceil(-low / kCell)) + kParameters.slack;
    return over > 0 ? -static_cast<int>(std::ceil(over / kCell)) - kParameters.slack : 0;
  };
  const int dx = cells_to_go(left_most, right_most, columns_), dy = cells_to_go(top_most, bottom_most, rows_);
  if (dx == 0 && dy == 0) return;
  shift_content(cells(), dx, dy, Cell{});
  to_mosaic_ = Transform::translation(kCell * dx, kCell * dy) * to_mosaic_;
}

void Mosaic::relight(int gain, int offset) {
  for (Cell& cell : cells_)
    for (std::uint8_t& mean : cell.mean)
      mean = static_cast<std::uint8_t>(std::clamp(mean * gain + offset + 128, 0, 255 << 8) >> 8);
}

}  // namespace cerberus::vision
