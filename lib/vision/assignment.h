// SPDX-License-Identifier: LGPL-2.1-or-later
// Who belongs to whom at the least total cost.
#pragma once

#include <span>
#include <vector>

namespace cerberus::vision {

// The assignment problem with gates, by shortest augmenting paths (H. W. Kuhn 1955; J. Munkres 1957; the
// O(rows^2 columns) form with row and column potentials). Memory grows to the largest problem seen and stays.
class Assignment {
 public:
  // A pair that may not be matched has this cost or a higher one.
  static constexpr double kForbidden = 1e6;

  // cost: rows x columns, row-major, each >= 0. Returns for each row its column, -1 for none. Matches as many
  // rows as the gates allow and, among those matchings, one of least total cost; deterministic. Lives until
  // the next call.
  std::span<const int> solve(std::span<const double> cost, int rows, int columns);

 private:
  void augment(int row);
  double cost(int row, int column) const;

  std::span<const double> cost_;
  int rows_ = 0, columns_ = 0;
  std::vector<double> row_potential_, column_potential_, distance_;
  std::vector<int> row_of_, previous_, column_of_;
  std::vector<char> done_;
};

}  // namespace cerberus::vision
