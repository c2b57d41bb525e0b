// SPDX-License-Identifier: LGPL-2.1-or-later
// Scoring places for people: by hand, against the obvious loop for every processor's code, and to the last byte.
#include "vision/detection/people_kernels.h"

#include <algorithm>
#include <memory>
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

// A body whose other parts are empty.
BodyBands body_of(const BodyBand& band) {
  const BodyBand none{band.above, band.above, 0, 0, 50, -50, 50, -50};
  return {none, band, none, none};
}

}  // namespace

START_TEST(a_body_gains_by_its_core_and_its_sides) {
  // Six columns; the band takes 10 of their rows, of which 4 lie above it. Core: columns 2 and 3; sides: 1 and 4.
  const auto above = sums_of({{4, 4}, {1, 4}, {0, 4}, {4, 4}, {2, 4}, {0, 4}});
  const auto below = sums_of({{4, 14}, {4, 14}, {10, 14}, {11, 13}, {3, 14}, {0, 14}});
  const BodyBand band{above.data(), below.data(), 1, 2, 100, -7, 30, -2};
  int scores[] = {1, 1, 1, 1000, 1, 1, 1};
  const int core = (10 + 7) * 100 + (0 + 2) * -7, sides = (3 + 1) * 30 + (7 + 9) * -2;
  ck_assert_int_eq(score_bodies(body_of(band), 3, 4, scores), core + sides);
  ck_assert_int_eq(scores[3], core + sides);
  for (const int x : {0, 1, 2, 4, 5, 6}) ck_assert_int_eq(scores[x], 1);
}
END_TEST

START_TEST(places_beside_one_another_gain_what_they_hold) {
  // Two columns of foreground, 12 and 13, 8 rows high, in a band of 10 rows and of a core of one column on either side of
  // the axis: at 13 the core holds both, at 12 and 14 the one, beyond none. Two sides of a column each.
  std::vector<std::pair<unsigned, unsigned>> columns(26, {0, 10});
  columns[12] = columns[13] = {8, 10};
  const auto below = sums_of(columns),
             above = sums_of(std::vector<std::pair<unsigned, unsigned>>(26, {0, 0}));
  const BodyBand band{above.data(), below.data(), 1, 2, 100, -7, 30, -2};
  std::vector<int> scores(27, 1);
  const int none = 20 * -7 + 20 * -2, sides = 16 * 100 + 4 * -7 + 20 * -2;
  const int beside = 8 * 100 + 12 * -7 + 8 * 30 + 12 * -2, beyond = 20 * -7 + 8 * 30 + 12 * -2;
  ck_assert_int_eq(score_bodies(body_of(band), 2, 25, scores.data()), sides);
  for (int x = 2; x < 25; ++x)
    ck_assert_int_eq(scores[static_cast<std::size_t>(x)], x == 13              ? sides
                                                          : x == 12 || x == 14 ? beside
                                                          : x == 11 || x == 15 ? beyond
                                                                               : none);
  for (const std::size_t x : {0, 1, 25, 26}) ck_assert_int_eq(scores[x], 1);
}
END_TEST

START_TEST(cells_that_are_not_counted_gain_nothing) {
  // Outside the picture, or explained by a person in front.
  const auto above = sums_of({{0, 0}, {0, 0}, {0, 0}, {0, 0}});
  const auto below = sums_of({{0, 0}, {0, 0}, {10, 10}, {10, 10}});
  const BodyBand band{above.data(), below.data(), 1, 2, 100, -7, 30, -2};
  int scores[3] = {};
  ck_assert_int_eq(score_bodies(body_of(band), 2, 3, scores), 10 * 100 + 10 * 30);
}
END_TEST

START_TEST(random_bodies_score_as_in_the_reference_loop_and_nothing_else_is_touched) {
  std::mt19937 random(3);
  const auto upto = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n + 1)); };
  for (int round = 0; round < 300; ++round) {
    const int columns = 1 + upto(90), reach = upto(columns / 2);
    // The last sum is the last readable thing. Each band has its own cells, at most as many as fit; one in four has none.
    const std::size_t bytes = (static_cast<std::size_t>(columns) + 1) * 4;
    const int most = kMostSummed / columns / 2;
    std::vector<std::unique_ptr<GuardedBytes>> memory;
    const auto sums = [&] {
      return reinterpret_cast<std::uint32_t*>(
          memory.emplace_back(std::make_unique<GuardedBytes>(bytes))->data());
    };
    BodyBands body;
    for (BodyBand& band : body) {
      auto *above = sums(), *below = sums();
      above[0] = below[0] = 0;
      for (int c = 0; c < columns; ++c) {
        const auto counted = static_cast<unsigned>(upto(most)), rows = static_cast<unsigned>(upto(most));
        above[c + 1] = above[c] + random() % (counted + 1) * kMoving + counted * kCounted;
        below[c + 1] =
            below[c] + (above[c + 1] - above[c]) + random() % (rows + 1) * kMoving + rows * kCounted;
      }
      const int core = upto(reach);
      band = {above,
              random() % 4 ? below : above,
              core,
              core + upto(reach - core),
              upto(200),
              -upto(200),
              upto(200) - 100,
              -upto(50)};
    }
    const int first = reach + upto(columns - 2 * reach), end = first + 1 + upto(columns - reach - first);
    std::vector<int> expected(static_cast<std::size_t>(columns) + 2, 77), scores = expected;
    const int highest = score_bodies_reference(body, first, end, expected.data());
    ck_assert_int_eq(score_bodies(body, first, end, scores.data()), highest);
    ck_assert(scores == expected);
    ck_assert_int_eq(highest, *std::max_element(expected.begin() + first, expected.begin() + end));
  }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "people_kernels",
      {a_body_gains_by_its_core_and_its_sides, places_beside_one_another_gain_what_they_hold,
       cells_that_are_not_counted_gain_nothing,
       random_bodies_score_as_in_the_reference_loop_and_nothing_else_is_touched});
}
