// SPDX-License-Identifier: LGPL-2.1-or-later
// Which changes of a standing camera's picture are those of a clock or a logo, by the times at which a block changes.
#include "vision/burnt_in/recurrent_changes.h"

#include <functional>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{320, 240};
constexpr int kRate = 25;
constexpr int kX = 3, kY = 5;  // the block that changes

// Frames of `seconds`, in which the block changes where changes(n) says so. Returns after how many seconds it becomes a
// candidate; negative: it does not.
double candidate_after(double seconds, const std::function<bool(int)>& changes, double share = 0) {
  RecurrentChanges recurrent;
  const BlockGrid grid(kSize);
  recurrent.resize(grid);
  Image<std::uint8_t> difference(kSize);
  for (int n = 1; n <= seconds * kRate; ++n) {
    difference.fill_bytes(0);
    if (changes(n)) {
      const int rows = static_cast<int>(share * kSize.height);
      for (int y = 0; y < rows; ++y)
        for (int x = 0; x < kSize.width; ++x) difference.view().at(x, y) = 100;
      for (int y = 4 * kY; y < 4 * kY + 4; ++y)
        for (int x = 8 * kX; x < 8 * kX + 8; ++x) difference.view().at(x, y) = 100;
    }
    recurrent.set_time(1.0 * n / kRate, 1.0 / kRate);
    recurrent.update(difference.view(), 10);
    if (recurrent.is_candidate(grid.at(kX, kY))) return 1.0 * n / kRate;
  }
  return -1;
}

}  // namespace

// Changes at 1, 2, 3, 4 s: the change at 2 s is the first that follows rest, that at 3 s the first in time, and at 4 s
// two have come in time, 3 s after the first.
START_TEST(a_block_that_changes_each_second_is_a_candidate_within_five_seconds) {
  const double after = candidate_after(6, [](int n) { return n % kRate == 0; });
  ck_assert_double_ge(after, 2.4);
  ck_assert_double_le(after, 5);
}
END_TEST

START_TEST(a_count_that_runs_in_every_frame_is_a_candidate_after_three_seconds) {
  const double after = candidate_after(6, [](int) { return true; });
  ck_assert_double_ge(after, 2.5);
  ck_assert_double_le(after, 3.2);
}
END_TEST

// A person: several frames in a row, then rest.
START_TEST(changes_of_several_frames_in_a_row_are_none) {
  ck_assert_double_lt(candidate_after(30, [](int n) { return n % (2 * kRate) < kRate / 2; }), 0);
}
END_TEST

// .5, 1.3, .7, 1.9, .9 s ...: single frames, but at no interval, nor at multiples of one.
START_TEST(changes_at_no_interval_are_none) {
  constexpr int kGaps[] = {13, 33, 18, 47, 23, 61};
  int next = kGaps[0], index = 0;
  const auto changes = [&](int n) {
    if (n != next) return false;
    index = (index + 1) % 6;
    next += kGaps[index];
    return true;
  };
  ck_assert_double_lt(candidate_after(60, changes), 0);
}
END_TEST

START_TEST(changes_of_a_third_of_the_picture_are_those_of_the_light) {
  ck_assert_double_lt(candidate_after(10, [](int n) { return n % kRate == 0; }, 0.35), 0);
  ck_assert_double_gt(candidate_after(10, [](int n) { return n % kRate == 0; }, 0.2), 0);
}
END_TEST

START_TEST(changes_are_no_longer_evidence_three_seconds_after_the_last) {
  RecurrentChanges recurrent;
  const BlockGrid grid(kSize);
  recurrent.resize(grid);
  Image<std::uint8_t> difference(kSize);
  for (int n = 1; n <= 9 * kRate; ++n) {
    difference.fill_bytes(0);
    if (n <= 6 * kRate && n % kRate == 0)
      for (int y = 4 * kY; y < 4 * kY + 4; ++y)
        difference.view().at(8 * kX + 2, y) = difference.view().at(8 * kX + 5, y) = 100;
    recurrent.set_time(1.0 * n / kRate, 1.0 / kRate);
    recurrent.update(difference.view(), 10);
    if (n == 6 * kRate) ck_assert(recurrent.is_candidate(grid.at(kX, kY)));
  }
  ck_assert(!recurrent.is_candidate(grid.at(kX, kY)));
}
END_TEST

START_TEST(a_clock_is_a_candidate_for_hours_and_one_change_in_an_hour_is_none) {
  RecurrentChanges recurrent;
  const BlockGrid grid(kSize);
  recurrent.resize(grid);
  Image<std::uint8_t> none(kSize), clock(kSize);
  clock.view().at(8 * kX, 4 * kY) = 100;
  for (int second = 1; second <= 1200; ++second) {
    clock.view().at(0, 0) = second % 300 == 1 ? 100 : 0;  // another block
    for (int n = 0; n < 5; ++n) {
      recurrent.set_time(second + 0.2 * n, 0.04);
      recurrent.update(n == 0 ? clock.view() : none.view(), 10);
    }
    if (second > 5) ck_assert_msg(recurrent.is_candidate(grid.at(kX, kY)), "after %d s", second);
    ck_assert(!recurrent.is_candidate(0));
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "recurrent_changes", {a_block_that_changes_each_second_is_a_candidate_within_five_seconds,
                            a_count_that_runs_in_every_frame_is_a_candidate_after_three_seconds,
                            changes_of_several_frames_in_a_row_are_none, changes_at_no_interval_are_none,
                            changes_of_a_third_of_the_picture_are_those_of_the_light,
                            changes_are_no_longer_evidence_three_seconds_after_the_last,
                            a_clock_is_a_candidate_for_hours_and_one_change_in_an_hour_is_none});
}
