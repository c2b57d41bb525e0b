// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/assignment.h"

#include <algorithm>
#include <limits>

namespace cerberus::vision {

// Beyond the real columns there are as many columns for "unmatched" as there are rows, so that a full matching always
// exists. A row that ends there, or on a forbidden pair, is without partner.
double Assignment::cost(int row, int column) const {
  if (column >= columns_) return unmatched_.empty() ? kForbidden : unmatched_[row];
  return std::min(cost_[static_cast<std::size_t>(row) * columns_ + column], kForbidden);
}

// Adds one row: grows the tree of shortest alternating paths from it until a free column is reached, then
// flips the path. Index 0 of the columns' arrays is the root ("no column yet"), columns count from 1.
void Assignment::augment(int row) {
  const int n = columns_ + rows_;
  std::fill(distance_.begin(), distance_.begin() + n + 1, std::numeric_limits<double>::infinity());
  std::fill(done_.begin(), done_.begin() + n + 1, 0);
  row_of_[0] = row;
  int column = 0;
  do {
    done_[column] = 1;
    const int r = row_of_[column];
    double least = std::numeric_limits<double>::infinity();
    int next = 0;
    for (int c = 1; c <= n; ++c) {
      if (done_[c]) continue;
      const double reduced = cost(r, c - 1) - row_potential_[r] - column_potential_[c];
      if (reduced < distance_[c]) {
        distance_[c] = reduced;
        previous_[c] = column;
      }
      if (distance_[c] < least) {
        least = distance_[c];
        next = c;
      }
    }
    for (int c = 0; c <= n; ++c) {
      if (done_[c]) {
        row_potential_[row_of_[c]] += least;
        column_potential_[c] -= least;
      } else {
        distance_[c] -= least;
      }
    }
    column = next;
  } while (row_of_[column] >= 0);
  while (column != 0) {
    row_of_[column] = row_of_[previous_[column]];
    column = previous_[column];
  }
}

void Assignment::reserve(int rows, int columns) {
  const auto r = static_cast<std::size_t>(rows), n = r + static_cast<std::size_t>(columns) + 1;
  row_potential_.reserve(r);
  column_of_.reserve(r);
  column_potential_.reserve(n);
  row_of_.reserve(n);
  distance_.resize(std::max(distance_.size(), n));
  done_.resize(std::max(done_.size(), n));
  previous_.resize(std::max(previous_.size(), n));
}

std::size_t Assignment::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return of(row_potential_) + of(column_potential_) + of(distance_) + of(row_of_) + of(previous_) +
         of(column_of_) + of(done_);
}

std::span<const int> Assignment::solve(std::span<const double> cost, int rows, int columns,
                                       std::span<const double> unmatched) {
  cost_ = cost;
  unmatched_ = unmatched;
  rows_ = rows;
  columns_ = columns;
  const auto n = static_cast<std::size_t>(rows + columns) + 1;
  row_potential_.assign(static_cast<std::size_t>(rows), 0);
  column_potential_.assign(n, 0);
  if (distance_.size() < n) reserve(rows, columns);
  row_of_.assign(n, -1);
  column_of_.assign(static_cast<std::size_t>(rows), -1);
  for (int r = 0; r < rows; ++r) augment(r);
  for (int c = 1; c <= columns; ++c)
    if (const int r = row_of_[c]; r >= 0 && this->cost(r, c - 1) < kForbidden) column_of_[r] = c - 1;
  cost_ = unmatched_ = {};
  return column_of_;
}

}  // namespace cerberus::vision
