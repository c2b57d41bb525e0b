// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/changed_places.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace cerberus::vision {

namespace {

constexpr int kCell = 8;  // pixels: a person of 24 pixels has three cells

double mean_difference(GrayView a, GrayView b, int x0, int y0) {
  long sum = 0;
  for (int y = y0; y < y0 + kCell; ++y) {
    const std::uint8_t *p = a.row(y) + x0, *q = b.row(y) + x0;
    for (int x = 0; x < kCell; ++x) sum += std::abs(p[x] - q[x]);
  }
  return static_cast<double>(sum) / (kCell * kCell);
}

}  // namespace

void ChangedPlaces::reset() {
  cells_.clear();
  columns_ = rows_ = 0;
}

void ChangedPlaces::update(GrayView now, GrayView earlier, double seconds, const VerificationParameters& p) {
  if (now.width / kCell != columns_ || now.height / kCell != rows_) {
    columns_ = now.width / kCell, rows_ = now.height / kCell;
    cells_.assign(static_cast<std::size_t>(columns_) * rows_, Cell{.since_look = p.most_waited});
    differences_.assign(cells_.size(), 0);
  }
  const bool known = earlier.size() == now.size() && !cells_.empty();
  for (Cell& cell : cells_)
    cell.changed = false, cell.since_look = std::min(cell.since_look + seconds, p.most_waited);
  if (!known) return;
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c)
      differences_[static_cast<std::size_t>(r) * columns_ + c] =
          mean_difference(now, earlier, c * kCell, r * kCell);
  sorted_.assign(differences_.begin(), differences_.end());
  const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
  std::ranges::nth_element(sorted_, middle);
  const double least = std::max(p.least_change, p.change_over_noise * *middle);
  for (std::size_t i = 0; i < cells_.size(); ++i) cells_[i].changed = differences_[i] > least;
}

double ChangedPlaces::share(const Box& box) const {
  const int left = std::max(0, static_cast<int>(std::lround(box.x / kCell)));
  const int right = std::min(columns_, static_cast<int>(std::lround(box.right() / kCell)));
  const int top = std::max(0, static_cast<int>(std::lround(box.y / kCell)));
  const int bottom = std::min(rows_, static_cast<int>(std::lround(box.bottom() / kCell)));
  int changed = 0;
  for (int r = top; r < bottom; ++r)
    for (int c = left; c < right; ++c) changed += at(c, r).changed;
  return left < right && top < bottom ? static_cast<double>(changed) / ((right - left) * (bottom - top)) : 0;
}

// The box of the free cells around one of them, which are then no longer free.
Box ChangedPlaces::grown(int column, int row) {
  constexpr int kNear = 2;  // cells: a body's parts lie no further apart
  int left = column, right = column, top = row, bottom = row;
  waiting_.assign(1, row * columns_ + column);
  at(column, row).free = false;
  while (!waiting_.empty()) {
    const int c = waiting_.back() % columns_, r = waiting_.back() / columns_;
    waiting_.pop_back();
    left = std::min(left, c), right = std::max(right, c), top = std::min(top, r),
    bottom = std::max(bottom, r);
    for (int y = std::max(0, r - kNear); y <= std::min(rows_ - 1, r + kNear); ++y)
      for (int x = std::max(0, c - kNear); x <= std::min(columns_ - 1, c + kNear); ++x)
        if (at(x, y).free) at(x, y).free = false, waiting_.push_back(y * columns_ + x);
  }
  return {double(left * kCell), double(top * kCell), double((right - left + 1) * kCell),
          double((bottom - top + 1) * kCell)};
}

std::span<const LookTarget> ChangedPlaces::places(std::span<const Box> hidden,
                                                  const VerificationParameters& p) {
  places_.clear();
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const Point middle{(c + 0.5) * kCell, (r + 0.5) * kCell};
      const bool covered = std::ranges::any_of(hidden, [&](const Box& box) {
        return middle.x >= box.x && middle.x < box.right() && middle.y >= box.y && middle.y < box.bottom();
      });
      at(c, r).free = at(c, r).changed && !covered;
    }
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      if (!at(c, r).free) continue;
      double waited = at(c, r).since_look;
      const Box box = grown(c, r);
      for (int y = static_cast<int>(box.y) / kCell; y < static_cast<int>(box.bottom()) / kCell; ++y)
        for (int x = static_cast<int>(box.x) / kCell; x < static_cast<int>(box.right()) / kCell; ++x)
          waited = std::min(waited, at(x, y).since_look);
      if (box.height >= p.least_place * rows_ * kCell) places_.push_back({box, waited});
    }
  return places_;
}

void ChangedPlaces::looked(const Box& region) {
  for (int r = 0; r < rows_; ++r)
    for (int c = 0; c < columns_; ++c) {
      const Point middle{(c + 0.5) * kCell, (r + 0.5) * kCell};
      if (middle.x >= region.x && middle.x < region.right() && middle.y >= region.y &&
          middle.y < region.bottom())
        at(c, r).since_look = 0;
    }
}

}  // namespace cerberus::vision
