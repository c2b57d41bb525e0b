// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/assignment.h"

#include <algorithm>
#include <limits>

namespace cerberus::vision {

// Every row also has a private column of cost kForbidden beyond the real ones: "unmatched". Whoever ends
// there, or on a forbidden pair, is without partner, and a full matching always exists.
double Assignment::cost(int row, int column) const {
  if (column >= columns_) return kForbidden;
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

std::span<const int> Assignment::solve(std::span<const double> cost, int rows, int columns) {
  cost_ = cost;
  rows_ = rows;
  columns_ = columns;
  const auto n = static_cast<std::size_t>(rows + columns) + 1;
  row_potential_.assign(static_cast<std::size_t>(rows), 0);
  column_potential_.assign(n, 0);
  if (distance_.size() < n) {
    distance_.resize(n);
    done_.resize(n);
    previous_.resize(n);
  }
  row_of_.assign(n, -1);
  column_of_.assign(static_cast<std::size_t>(rows), -1);
  for (int r = 0; r < rows; ++r) augment(r);
  for (int c = 1; c <= columns; ++c)
    if (const int r = row_of_[c]; r >= 0 && this->cost(r, c - 1) < kForbidden) column_of_[r] = c - 1;
  cost_ = {};
  return column_of_;
}

}  // namespace cerberus::vision
