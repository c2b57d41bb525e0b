// SPDX-License-Identifier: LGPL-2.1-or-later
// Assignment of rows to columns at the least total cost.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace cerberus::vision {

// The assignment problem with gates, by shortest augmenting paths (H. W. Kuhn 1955; J. Munkres 1957; the
// O(rows^2 columns) form with row and column potentials). Memory grows to the largest problem seen and stays.
class Assignment {
 public:
  // A pair that may not be matched has this cost or a higher one.
  static constexpr double kForbidden = 1e6;

  // Memory: problems up to this size allocate nothing.
  void reserve(int rows, int columns);

  // cost: rows x columns, row-major, each >= 0. unmatched: cost of each row without partner; none given: kForbidden,
  // then as many rows are matched as the gates allow. Returns for each row its column, -1 for none, at the least total
  // cost; deterministic. Lives until the next call.
  std::span<const int> solve(std::span<const double> cost, int rows, int columns,
                             std::span<const double> unmatched = {});

  std::size_t bytes() const;

 private:
  void augment(int row);
  double cost(int row, int column) const;

  std::span<const double> cost_, unmatched_;
  int rows_ = 0, columns_ = 0;
  std::vector<double> row_potential_, column_potential_, distance_;
  std::vector<int> row_of_, previous_, column_of_;
  std::vector<char> done_;
};

}  // namespace cerberus::vision
