// SPDX-License-Identifier: LGPL-2.1-or-later
// The candidate background's kernel against its scalar reference, on every vector target of this processor, and the reference
// against values computed by hand.
#include "vision/background/candidate_kernels.h"

#include <check.h>

#include <random>
#include <vector>

#include "support/targets.h"
#include "vision/image/mask.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

void scatter(Image<std::uint8_t>& row, int width, std::mt19937& random, unsigned from, unsigned below) {
  row.resize({width, 1});
  for (int x = 0; x < width; ++x) row.view().at(x, 0) = static_cast<std::uint8_t>(from + random() % below);
}

struct Result {
  Image<std::uint8_t> grey, seen;
  std::vector<std::uint64_t> lasting;
};

}  // namespace

START_TEST(counting_agrees_with_the_reference) {
  std::mt19937 random(1);
  for (const int width : {1, 7, 16, 33, 49, 64, 65, 200, 320})
    for (int round = 0; round < 20; ++round) {
      // Grey levels that mostly lie near one another, ages and counts near the limits.
      Image<std::uint8_t> frame, above, below, age, quiet;
      for (auto* row : {&frame, &above, &below}) scatter(*row, width, random, 90, round % 2 ? 40 : 12);
      scatter(age, width, random, 0, 90);
      scatter(quiet, width, random, 0, 2);
      const auto words = static_cast<std::size_t>(width + 63) / 64;
      std::vector<std::uint64_t> foreground(words);
      for (auto& word : foreground)
        word = random() % 4 ? static_cast<std::uint64_t>(random()) << 32 | random() : 0;
      Result fast, slow;
      scatter(fast.grey, width, random, 90, 40);
      scatter(fast.seen, width, random, round % 3 ? 0 : 245, round % 3 ? 20 : 11);
      slow.grey.resize({width, 1}), slow.seen.resize({width, 1});
      for (int x = 0; x < width; ++x) {
        slow.grey.view().at(x, 0) = fast.grey.view().at(x, 0);
        slow.seen.view().at(x, 0) = fast.seen.view().at(x, 0);
      }
      fast.lasting.assign(words, ~std::uint64_t{0});
      slow.lasting.assign(words, 0);
      CandidateLimits limits;
      for (auto& same : limits.same) same = static_cast<std::uint8_t>(9 + random() % 10);
      limits.contrast = 12, limits.least_seen = 11;
      CandidateRow row{
          frame.view().data, above.view().data, below.view().data, age.view().data, quiet.view().data,
          foreground.data(), nullptr,           nullptr,           nullptr,         width};
      row.grey = fast.grey.view().data, row.seen = fast.seen.view().data, row.lasting = fast.lasting.data();
      count_candidates(row, limits);
      row.grey = slow.grey.view().data, row.seen = slow.seen.view().data, row.lasting = slow.lasting.data();
      count_candidates_reference(row, limits, 0, width);
      for (int x = 0; x < width; ++x) {
        ck_assert_int_eq(fast.grey.view().at(x, 0), slow.grey.view().at(x, 0));
        ck_assert_int_eq(fast.seen.view().at(x, 0), slow.seen.view().at(x, 0));
      }
      for (std::size_t i = 0; i < words; ++i) ck_assert_uint_eq(fast.lasting[i], slow.lasting[i]);
    }
}
END_TEST

// A candidate of 100, from which 9 levels are the same; an edge is more than 12; 11 frames last, beside an age of 40.
START_TEST(counting_follows_its_definition_on_single_pixels) {
  struct Case {
    int frame, seen, quiet, above, age;
    bool foreground;
    int grey, next;  // afterwards
    bool lasting;
  };
  const Case cases[] = {{109, 5, 1, 80, 40, true, 102, 6, false},  // the same; it follows by a quarter
                        {91, 5, 1, 80, 40, true, 98, 6, false},    // 2 of 9, towards 0
                        {100, 5, 0, 80, 40, true, 100, 5, false},  // it moves
                        {100, 5, 1, 88, 40, true, 100, 5, false},  // no edge: 12
                        {100, 5, 1, 87, 40, true, 100, 6, false},
                        {100, 10, 1, 80, 40, true, 100, 11, true},  // for long, and more than a quarter of 40
                        {100, 9, 1, 80, 40, true, 100, 10, false},
                        {100, 11, 0, 100, 40, true, 100, 11, true},  // it lasts where it does not count, too
                        {100, 10, 1, 80, 44, true, 100, 11, false},  // the model is as old
                        {100, 255, 1, 80, 40, true, 100, 255, true},
                        {110, 5, 1, 80, 40, true, 100, 4, false},   // another
                        {110, 1, 1, 80, 40, true, 110, 1, false},   // which replaces it
                        {100, 0, 1, 80, 40, true, 100, 1, false},   // the first
                        {110, 5, 1, 80, 40, false, 100, 5, false},  // the background
                        {100, 20, 1, 80, 40, false, 100, 20, false}};
  for (const Case& c : cases) {
    const auto at = [](int v) { return static_cast<std::uint8_t>(v); };
    const std::uint8_t frame = at(c.frame), above = at(c.above), below = 100, age = at(c.age),
                       quiet = at(c.quiet);
    std::uint8_t grey = 100, seen = at(c.seen);
    const std::uint64_t foreground = c.foreground;
    std::uint64_t lasting = 0;
    CandidateLimits limits;
    limits.same.fill(200);
    limits.same[100 / 16] = 9;
    limits.contrast = 12, limits.least_seen = 11;
    count_candidates_reference({&frame, &above, &below, &age, &quiet, &foreground, &grey, &seen, &lasting, 1},
                               limits, 0, 1);
    ck_assert_msg(grey == c.grey && seen == c.next && lasting == c.lasting,
                  "frame %d seen %d above %d: %d %d %d", c.frame, c.seen, c.above, grey, seen,
                  static_cast<int>(lasting));
  }
}
END_TEST

int main() {
  return run_suite_on_every_target("candidate_kernels", {counting_agrees_with_the_reference,
                                                         counting_follows_its_definition_on_single_pixels});
}
