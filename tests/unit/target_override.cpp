// SPDX-License-Identifier: LGPL-2.1-or-later
// The track that an application chose: how long it counts.
#include "fusion/target_override.h"

#include <check.h>

#include "../support/suite.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;
using Answer = TargetOverride::Answer;

START_TEST(a_chosen_track_on_the_frame_is_followed) {
  TargetOverride target;
  ck_assert(target.watch(true, 0s) == Answer::none);  // no override
  target.choose(7);
  for (Time time = 0s; time < 100s; time += 40ms) ck_assert(target.watch(true, time) == Answer::here);
  ck_assert_uint_eq(target.id(), 7);
}
END_TEST

START_TEST(a_missing_track_is_awaited_and_followed_again_within_five_seconds) {
  TargetOverride target;
  target.choose(7);
  ck_assert(target.watch(true, 10s) == Answer::here);
  ck_assert(target.watch(false, 10040ms) == Answer::awaited);
  ck_assert(target.watch(false, 14999ms) == Answer::awaited);
  ck_assert(target.watch(true, 15s) == Answer::here);
  ck_assert(target.watch(false, 19999ms) == Answer::awaited);  // five seconds anew
  ck_assert(target.watch(false, 20s) == Answer::lost);
}
END_TEST

START_TEST(a_track_that_stays_away_is_lost_once_and_for_all) {
  TargetOverride target;
  target.choose(7);
  target.watch(true, 1s);
  ck_assert(target.watch(false, 6s) == Answer::lost);
  ck_assert_uint_eq(target.id(), 0);
  ck_assert(target.watch(false, 7s) == Answer::none);
  ck_assert(target.watch(true, 8s) == Answer::none);
}
END_TEST

START_TEST(a_track_that_never_came_is_lost_five_seconds_after_the_first_frame) {
  TargetOverride target;
  target.choose(7);
  ck_assert(target.watch(false, 100s) == Answer::none);  // nothing to wait for yet
  ck_assert(target.watch(false, 104999ms) == Answer::none);
  ck_assert(target.watch(false, 105s) == Answer::lost);
}
END_TEST

START_TEST(the_same_frame_may_be_looked_at_twice) {
  TargetOverride target;
  target.choose(7);
  for (int twice = 0; twice < 2; ++twice) ck_assert(target.watch(true, 1s) == Answer::here);
  for (int twice = 0; twice < 2; ++twice) ck_assert(target.watch(false, 1100ms) == Answer::awaited);
}
END_TEST

START_TEST(a_new_choice_begins_anew_and_none_ends_it) {
  TargetOverride target;
  target.choose(7);
  target.watch(true, 1s);
  target.choose(8);
  ck_assert(target.watch(false, 1100ms) == Answer::none);  // 8 has not been here
  ck_assert(target.watch(false, 6099ms) == Answer::none);
  ck_assert_uint_eq(target.id(), 8);
  target.choose(0);
  ck_assert(target.watch(true, 6200ms) == Answer::none);
}
END_TEST

START_TEST(when_time_begins_anew_so_does_the_waiting) {
  TargetOverride target;
  target.choose(7);
  target.watch(true, 100s);
  target.restart();
  ck_assert_uint_eq(target.id(), 7);
  ck_assert(target.watch(false, 0s) == Answer::none);
  ck_assert(target.watch(false, 4999ms) == Answer::none);
  ck_assert(target.watch(false, 5s) == Answer::lost);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "target_override", {a_chosen_track_on_the_frame_is_followed,
                          a_missing_track_is_awaited_and_followed_again_within_five_seconds,
                          a_track_that_stays_away_is_lost_once_and_for_all,
                          a_track_that_never_came_is_lost_five_seconds_after_the_first_frame,
                          the_same_frame_may_be_looked_at_twice, a_new_choice_begins_anew_and_none_ends_it,
                          when_time_begins_anew_so_does_the_waiting});
}
