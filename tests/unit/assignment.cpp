// SPDX-License-Identifier: LGPL-2.1-or-later
// The assignment against trying every possibility.
#include "vision/tracking/assignment.h"

#include <check.h>

#include <algorithm>
#include <random>
#include <vector>

#include "support/suite.h"

using cerberus::vision::Assignment;

namespace {

struct Best {
  int matched = -1;
  double total = 0;
};

// Every matching, by recursion over the rows.
void try_all(const std::vector<double>& cost, int rows, int columns, int row, std::vector<char>& used,
             int matched, double total, Best& best) {
  if (row == rows) {
    if (matched > best.matched || (matched == best.matched && total < best.total)) best = {matched, total};
    return;
  }
  try_all(cost, rows, columns, row + 1, used, matched, total, best);
  for (int c = 0; c < columns; ++c) {
    const double v = cost[static_cast<std::size_t>(row * columns + c)];
    if (used[static_cast<std::size_t>(c)] || v >= Assignment::kForbidden) continue;
    used[static_cast<std::size_t>(c)] = 1;
    try_all(cost, rows, columns, row + 1, used, matched + 1, total + v, best);
    used[static_cast<std::size_t>(c)] = 0;
  }
}

}  // namespace

START_TEST(the_greedy_choice_is_not_taken_when_it_costs_more) {
  // Greedy takes 1 and then pays 10; the best is 2 + 3.
  const std::vector<double> cost = {1, 2, 3, 10};
  Assignment assignment;
  const auto columns = assignment.solve(cost, 2, 2);
  ck_assert_int_eq(columns[0], 1);
  ck_assert_int_eq(columns[1], 0);
}
END_TEST

START_TEST(nothing_to_match_gives_nothing) {
  Assignment assignment;
  ck_assert_uint_eq(assignment.solve({}, 0, 5).size(), 0);
  const auto columns = assignment.solve({}, 2, 0);
  ck_assert_uint_eq(columns.size(), 2);
  ck_assert_int_eq(columns[0], -1);
  ck_assert_int_eq(columns[1], -1);
}
END_TEST

START_TEST(a_row_that_costs_less_unmatched_has_no_partner) {
  // Alone row 0 would take column 0; row 1 fits there, and has nothing else as good.
  const std::vector<double> cost = {1.2, Assignment::kForbidden, 0.3, 1.3}, price = {2, 2}, high = {3, 2};
  Assignment assignment;
  ck_assert_int_eq(assignment.solve(cost, 2, 2, price)[0], -1);  // 2 + .3 < 1.2 + 1.3
  ck_assert_int_eq(assignment.solve(cost, 2, 2, price)[1], 0);
  ck_assert_int_eq(assignment.solve(cost, 2, 2, high)[0], 0);  // 3 + .3 > 1.2 + 1.3
  ck_assert_int_eq(assignment.solve(cost, 2, 2, high)[1], 1);
  ck_assert_int_eq(assignment.solve(std::span(cost).first(1), 1, 1, price)[0], 0);
}
END_TEST

START_TEST(random_gated_problems_match_the_exhaustive_search) {
  std::mt19937 random(5);
  Assignment assignment;
  for (int round = 0; round < 600; ++round) {
    const int rows = static_cast<int>(random() % 6), columns = static_cast<int>(random() % 6);
    std::vector<double> cost(static_cast<std::size_t>(rows * columns));
    for (double& c : cost)
      c = random() % 3 == 0 ? Assignment::kForbidden : static_cast<double>(random() % 1000) / 100;
    Best best;
    std::vector<char> used(static_cast<std::size_t>(columns), 0);
    try_all(cost, rows, columns, 0, used, 0, 0, best);
    const auto found = assignment.solve(cost, rows, columns);
    int matched = 0;
    double total = 0;
    std::vector<char> taken(static_cast<std::size_t>(columns), 0);
    for (int r = 0; r < rows; ++r) {
      const int c = found[static_cast<std::size_t>(r)];
      if (c < 0) continue;
      ck_assert(!taken[static_cast<std::size_t>(c)]);
      taken[static_cast<std::size_t>(c)] = 1;
      const double v = cost[static_cast<std::size_t>(r * columns + c)];
      ck_assert_double_lt(v, Assignment::kForbidden);
      ++matched;
      total += v;
    }
    ck_assert_int_eq(matched, best.matched);
    ck_assert_double_eq_tol(total, best.total, 1e-6);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "assignment",
      {the_greedy_choice_is_not_taken_when_it_costs_more, nothing_to_match_gives_nothing,
       a_row_that_costs_less_unmatched_has_no_partner, random_gated_problems_match_the_exhaustive_search});
}
