// SPDX-License-Identifier: LGPL-2.1-or-later
// The track that an application chose: how long it counts.
#include "fusion/chosen.h"

#include <check.h>

#include "../support/suite.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;
using Answer = Chosen::Answer;

START_TEST(who_is_on_the_frame_is_followed) {
  Chosen chosen;
  ck_assert(chosen.watch(true, 0s) == Answer::nobody);  // nobody was chosen
  chosen.choose(7);
  for (Time time = 0s; time < 100s; time += 40ms) ck_assert(chosen.watch(true, time) == Answer::here);
  ck_assert_uint_eq(chosen.id(), 7);
}
END_TEST

START_TEST(who_was_here_is_waited_for_and_followed_again_within_five_seconds) {
  Chosen chosen;
  chosen.choose(7);
  ck_assert(chosen.watch(true, 10s) == Answer::here);
  ck_assert(chosen.watch(false, 10040ms) == Answer::awaited);
  ck_assert(chosen.watch(false, 14999ms) == Answer::awaited);
  ck_assert(chosen.watch(true, 15s) == Answer::here);
  ck_assert(chosen.watch(false, 19999ms) == Answer::awaited);  // five seconds anew
  ck_assert(chosen.watch(false, 20s) == Answer::lost);
}
END_TEST

START_TEST(who_stays_away_is_lost_once_and_for_all) {
  Chosen chosen;
  chosen.choose(7);
  chosen.watch(true, 1s);
  ck_assert(chosen.watch(false, 6s) == Answer::lost);
  ck_assert_uint_eq(chosen.id(), 0);
  ck_assert(chosen.watch(false, 7s) == Answer::nobody);
  ck_assert(chosen.watch(true, 8s) == Answer::nobody);
}
END_TEST

START_TEST(who_never_came_is_lost_five_seconds_after_the_first_frame) {
  Chosen chosen;
  chosen.choose(7);
  ck_assert(chosen.watch(false, 100s) == Answer::nobody);  // nothing to wait for yet
  ck_assert(chosen.watch(false, 104999ms) == Answer::nobody);
  ck_assert(chosen.watch(false, 105s) == Answer::lost);
}
END_TEST

START_TEST(the_same_frame_may_be_looked_at_twice) {
  Chosen chosen;
  chosen.choose(7);
  for (int twice = 0; twice < 2; ++twice) ck_assert(chosen.watch(true, 1s) == Answer::here);
  for (int twice = 0; twice < 2; ++twice) ck_assert(chosen.watch(false, 1100ms) == Answer::awaited);
}
END_TEST

START_TEST(a_new_choice_begins_anew_and_none_ends_it) {
  Chosen chosen;
  chosen.choose(7);
  chosen.watch(true, 1s);
  chosen.choose(8);
  ck_assert(chosen.watch(false, 1100ms) == Answer::nobody);  // 8 has not been here
  ck_assert(chosen.watch(false, 6099ms) == Answer::nobody);
  ck_assert_uint_eq(chosen.id(), 8);
  chosen.choose(0);
  ck_assert(chosen.watch(true, 6200ms) == Answer::nobody);
}
END_TEST

START_TEST(when_time_begins_anew_so_does_the_waiting) {
  Chosen chosen;
  chosen.choose(7);
  chosen.watch(true, 100s);
  chosen.restart();
  ck_assert_uint_eq(chosen.id(), 7);
  ck_assert(chosen.watch(false, 0s) == Answer::nobody);
  ck_assert(chosen.watch(false, 4999ms) == Answer::nobody);
  ck_assert(chosen.watch(false, 5s) == Answer::lost);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "chosen",
      {who_is_on_the_frame_is_followed, who_was_here_is_waited_for_and_followed_again_within_five_seconds,
       who_stays_away_is_lost_once_and_for_all, who_never_came_is_lost_five_seconds_after_the_first_frame,
       the_same_frame_may_be_looked_at_twice, a_new_choice_begins_anew_and_none_ends_it,
       when_time_begins_anew_so_does_the_waiting});
}
