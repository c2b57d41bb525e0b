// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/retention.h"

#include <check.h>

#include <initializer_list>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using std::chrono::days;
using std::chrono::hours;
using std::chrono::minutes;

namespace {

// Day 100 of the clock, and plenty of room.
Surroundings day(int utc, Time steady = hours(5), std::uint64_t free = 1'000'000) {
  return {days(utc), steady, free};
}

Candidate of_day(std::int64_t id, int end, std::uint64_t bytes = 100) {
  return {id, days(end), bytes, false, false};
}

using Ids = std::vector<std::int64_t>;

}  // namespace

START_TEST(what_is_older_than_the_age_is_deleted_and_what_is_as_old_is_not) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 92), of_day(2, 93), of_day(3, 99)};
  ck_assert(retention.expired(all, {days(7), 0, 0}, day(100)) == Ids{1});
}
END_TEST

START_TEST(no_limit_deletes_nothing) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 1), of_day(2, 100)};
  ck_assert(retention.expired(all, {Time::zero(), 0, 0}, day(100, hours(5), 0)).empty());
}
END_TEST

START_TEST(the_oldest_are_deleted_until_the_total_fits) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 97), of_day(2, 98), of_day(3, 99), of_day(4, 100)};
  const Ids expected = {1, 2};
  ck_assert(retention.expired(all, {days(7), 250, 0}, day(100)) == expected);
}
END_TEST

START_TEST(the_oldest_are_deleted_until_there_is_room) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 97), of_day(2, 98), of_day(3, 99)};
  const Ids expected = {1, 2};
  ck_assert(retention.expired(all, {days(7), 0, 1000}, day(100, hours(5), 850)) == expected);
}
END_TEST

START_TEST(what_is_kept_and_what_is_open_is_never_deleted) {
  Retention retention;
  std::vector<Candidate> all = {of_day(1, 50), of_day(2, 51), of_day(3, 98), of_day(4, 99)};
  all[0].keep = true;
  all[1].open = true;
  ck_assert(retention.expired(all, {days(7), 150, 0}, day(100)) == Ids{3});
}
END_TEST

START_TEST(a_clock_that_jumps_ahead_deletes_nothing_by_age_for_an_hour) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 98), of_day(2, 99)};
  const Limits limits{days(7), 0, 0};
  ck_assert(retention.expired(all, limits, day(100, minutes(0))).empty());
  ck_assert(retention.expired(all, limits, day(5000, minutes(1))).empty());  // a glitch
  ck_assert(retention.expired(all, limits, {days(5000) + minutes(29), minutes(30), 1000}).empty());
  ck_assert(
      retention.expired(all, limits, {days(100) + minutes(40), minutes(40), 1000}).empty());  // put right
  ck_assert(retention.expired(all, limits, {days(100) + hours(5), hours(5), 1000}).empty());
  ck_assert(retention.expired(all, limits, {days(106), days(6), 1000}) == Ids{1});
}
END_TEST

START_TEST(a_clock_that_stays_ahead_counts_after_an_hour) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 98)};
  const Limits limits{days(7), 0, 0};
  ck_assert(retention.expired(all, limits, day(100, minutes(0))).empty());
  ck_assert(retention.expired(all, limits, {days(120), minutes(1), 1000}).empty());
  ck_assert(retention.expired(all, limits, {days(120) + minutes(59), minutes(60), 1000}).empty());
  ck_assert(retention.expired(all, limits, {days(120) + minutes(60), minutes(61), 1000}) == Ids{1});
}
END_TEST

START_TEST(a_clock_that_falls_back_deletes_nothing_and_size_still_counts_by_order) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 98), of_day(2, 99),
                                      of_day(3, 3)};  // the newest, after the fall
  ck_assert(retention.expired(all, {days(7), 0, 0}, day(3)).empty());
  Retention by_size;
  ck_assert(by_size.expired(all, {days(7), 250, 0}, day(3)) == Ids{1});
}
END_TEST

START_TEST(room_that_deletion_cannot_make_deletes_nothing) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 97), of_day(2, 98), of_day(3, 99)};
  ck_assert(retention.expired(all, {days(7), 0, 1000}, day(100, hours(5), 799)).empty());  // 799 + 200
  ck_assert(retention.take_fault().find("retention-free") != std::string::npos);
  ck_assert(retention.expired(all, {days(7), 0, 1000}, day(100, hours(5), 798)).empty());
  ck_assert(retention.take_fault().empty());  // the same one
  const Ids expected = {1, 2};
  ck_assert(retention.expired(all, {days(7), 0, 1000}, day(100, hours(5), 800)) == expected);
  ck_assert(retention.take_fault().empty());
}
END_TEST

START_TEST(kept_recordings_beyond_the_size_delete_no_other_ones) {
  Retention retention;
  std::vector<Candidate> all = {of_day(1, 97), of_day(2, 98), of_day(3, 99)};
  all[0].keep = true;
  ck_assert(retention.expired(all, {days(7), 99, 0}, day(100)).empty());
  ck_assert(retention.take_fault().find("retention-size") != std::string::npos);
  ck_assert(retention.expired(all, {days(7), 100, 0}, day(100)) == Ids{2});  // the newest stays
  ck_assert(retention.take_fault().empty());
}
END_TEST

START_TEST(a_recording_is_no_older_than_those_before_it) {
  const std::vector<Candidate> all = {of_day(1, 92), of_day(2, 98), of_day(3, 1), of_day(4, 99)};
  ck_assert(Retention().expired(all, {days(7), 0, 0}, day(100)) == Ids{1});
  const Ids later = {1, 2, 3};
  ck_assert(Retention({.absence = days(30)}).expired(all, {days(7), 0, 0}, day(106)) == later);
}
END_TEST

START_TEST(a_recording_of_the_future_keeps_no_other_one) {
  const std::vector<Candidate> all = {of_day(1, 5000), of_day(2, 92), of_day(3, 99)};
  ck_assert(Retention().expired(all, {days(7), 0, 0}, day(100)) == Ids{2});
}
END_TEST

START_TEST(after_a_start_with_old_recordings_only_age_counts_after_an_hour) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 50)};
  const Limits limits{days(7), 0, 0};
  ck_assert(retention.expired(all, limits, day(100, minutes(0))).empty());
  ck_assert(retention.expired(all, limits, {days(100) + minutes(60), minutes(60), 1000}) == Ids{1});
}
END_TEST

int main() {
  Suite* suite = suite_create("retention");
  TCase* cases = tcase_create("retention");
  for (const TTest* test :
       {what_is_older_than_the_age_is_deleted_and_what_is_as_old_is_not, no_limit_deletes_nothing,
        the_oldest_are_deleted_until_the_total_fits, the_oldest_are_deleted_until_there_is_room,
        what_is_kept_and_what_is_open_is_never_deleted,
        a_clock_that_jumps_ahead_deletes_nothing_by_age_for_an_hour,
        a_clock_that_stays_ahead_counts_after_an_hour,
        a_clock_that_falls_back_deletes_nothing_and_size_still_counts_by_order,
        room_that_deletion_cannot_make_deletes_nothing, kept_recordings_beyond_the_size_delete_no_other_ones,
        a_recording_is_no_older_than_those_before_it, a_recording_of_the_future_keeps_no_other_one,
        after_a_start_with_old_recordings_only_age_counts_after_an_hour})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
