// SPDX-License-Identifier: LGPL-2.1-or-later
// Scoring places for people: by hand, against the obvious loop for every processor's code, and to the last byte.
#include "vision/detection/people_kernels.h"

#include <algorithm>
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
    // The last sum is the last readable thing.
    const std::size_t bytes = (static_cast<std::size_t>(columns) + 1) * 4;
    GuardedBytes memory(bytes), more(bytes);
    auto* above = reinterpret_cast<std::uint32_t*>(memory.data());
    auto* below = reinterpret_cast<std::uint32_t*>(more.data());
    above[0] = below[0] = 0;
    for (int c = 0; c < columns; ++c) {
      const auto counted = static_cast<unsigned>(upto(60)), rows = static_cast<unsigned>(upto(60));
      above[c + 1] = above[c] + random() % (counted + 1) * kMoving + counted * kCounted;
      below[c + 1] = below[c] + (above[c + 1] - above[c]) + random() % (rows + 1) * kMoving + rows * kCounted;
    }
    BodyBands body;
    for (BodyBand& band : body) {
      const int core = upto(reach);
      band = {above,      below,           core,     core + upto(reach - core), upto(200),
              -upto(200), upto(200) - 100, -upto(50)};
    }
    const int first = reach + upto(columns - 2 * reach), end = first + 1 + upto(columns - reach - first);
    std::vector<int> expected(static_cast<std::size_t>(columns) + 2, 77), scores = expected;
    const int most = score_bodies_reference(body, first, end, expected.data());
    ck_assert_int_eq(score_bodies(body, first, end, scores.data()), most);
    ck_assert(scores == expected);
    ck_assert_int_eq(most, *std::max_element(expected.begin() + first, expected.begin() + end));
  }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "people_kernels", {a_body_gains_by_its_core_and_its_sides, cells_that_are_not_counted_gain_nothing,
                         random_bodies_score_as_in_the_reference_loop_and_nothing_else_is_touched});
}
