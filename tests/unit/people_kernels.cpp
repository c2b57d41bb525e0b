// SPDX-License-Identifier: LGPL-2.1-or-later
// Scoring places for people: by hand, against the obvious loop for every processor's code, and to the last byte.
#include "vision/detection/people_kernels.h"

#include <climits>
#include <random>
#include <vector>

#include "support/pictures.h"
#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

// sums[x] of columns that hold (moving, counted) cells.
std::vector<std::uint32_t> sums_of(const std::vector<std::pair<unsigned, unsigned>>& columns) {
  std::vector<std::uint32_t> sums{0};
  for (const auto& [moving, counted] : columns)
    sums.push_back(sums.back() + moving * kMoving + counted * kCounted);
  return sums;
}

}  // namespace

START_TEST(a_score_is_the_gain_of_core_and_sides_less_the_price) {
  // Six columns of 10 rows, the box is four wide with one on either side: columns 1 to 4.
  const auto sums = sums_of({{0, 10}, {3, 10}, {10, 10}, {7, 9}, {1, 10}, {0, 10}});
  const BoxRow row{sums.data(), 4, 1, 0, 6, 10};
  int scores[3];
  const int core = (10 + 7) * kCoreMoving + (0 + 2) * kCoreStill,
            sides = (3 + 1) * kSideMoving + (7 + 9) * kSideStill;
  const int highest = score_boxes(row, 0, 3, scores);
  ck_assert_int_eq(scores[1], core + sides - 4 * 10 * kPrice);
  ck_assert_int_eq(highest, std::max({scores[0], scores[1], scores[2]}));
  ck_assert_int_eq(highest, scores[1]);
}
END_TEST

START_TEST(columns_outside_the_picture_cost_nothing) {
  // Nothing is counted in the first two columns: they are outside.
  const auto sums = sums_of({{0, 0}, {0, 0}, {10, 10}, {10, 10}, {0, 10}});
  const BoxRow row{sums.data(), 4, 1, 2, 5, 10};
  int score = 0;
  score_boxes(row, 0, 1, &score);
  ck_assert_int_eq(score, 10 * kCoreMoving + 10 * kSideMoving - 2 * 10 * kPrice);
}
END_TEST

START_TEST(random_boxes_score_as_in_the_reference_loop_and_nothing_else_is_touched) {
  std::mt19937 random(3);
  const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n + 1)); };
  for (int round = 0; round < 300; ++round) {
    const int columns = 1 + upto(90), width = 1 + upto(columns - 1), rows = 1 + upto(120);
    // The last sum is the last readable thing.
    GuardedBytes memory((static_cast<std::size_t>(columns) + 1) * 4);
    auto* sums = reinterpret_cast<std::uint32_t*>(memory.data());
    sums[0] = 0;
    for (int c = 0; c < columns; ++c) {
      const auto counted = static_cast<unsigned>(upto(rows));
      sums[c + 1] = sums[c] + random() % (counted + 1) * kMoving + counted * kCounted;
    }
    const int left = upto(columns / 2), right = left + upto(columns - left);
    const BoxRow row{sums, width, width / 4, left, right, rows};
    const int first = upto(columns - width), end = first + 1 + upto(columns - width - first);
    std::vector<int> expected(static_cast<std::size_t>(columns) + 1, 77), scores = expected;
    const int highest = score_boxes_reference(row, first, end, expected.data());
    std::fill(scores.begin(), scores.end(), 77);
    ck_assert_int_eq(score_boxes(row, first, end, scores.data()), highest);
    ck_assert(scores == expected);
  }
}
END_TEST

START_TEST(cells_add_up_and_are_taken_away_again_unless_explained) {
  std::mt19937 random(5);
  for (const int columns : {1, 2, 7, 8, 15, 16, 17, 33, 64, 131}) {
    GuardedBytes memory(static_cast<std::size_t>(columns));
    std::uint8_t* cells = memory.data();
    const std::uint8_t kinds[] = {0, kCellCounted, kCellCounted | kCellMoving,
                                  kCellCounted | kCellMoving | kCellExplained, kCellCounted | kCellExplained};
    for (int c = 0; c < columns; ++c) cells[c] = kinds[random() % 5];
    std::vector<std::uint32_t> sums(static_cast<std::size_t>(columns) + 1, 5 * kCounted + 3 * kMoving);
    const auto before = sums;
    add_cells(cells, columns, sums.data());
    for (int c = 0; c < columns; ++c) {
      const std::uint32_t one = cells[c] == kCellCounted                   ? kCounted
                                : cells[c] == (kCellCounted | kCellMoving) ? kCounted + kMoving
                                                                           : 0;
      ck_assert_uint_eq(sums[c], before[c] + one);
    }
    ck_assert_uint_eq(sums[columns], before[columns]);
    subtract_cells(cells, columns, sums.data());
    ck_assert(sums == before);
  }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "people_kernels",
      {a_score_is_the_gain_of_core_and_sides_less_the_price, columns_outside_the_picture_cost_nothing,
       random_boxes_score_as_in_the_reference_loop_and_nothing_else_is_touched,
       cells_add_up_and_are_taken_away_again_unless_explained});
}
