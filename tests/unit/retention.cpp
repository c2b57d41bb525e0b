// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/retention.h"

#include <check.h>

#include <algorithm>
#include <initializer_list>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using std::chrono::days;
using std::chrono::hours;
using std::chrono::minutes;

namespace {

// Days are counted from the beginning of 2026.
Time on(int day) {
  return days(20454 + day);
}

// A day of the clock, and plenty of room.
Surroundings day(int utc, Time steady = hours(5), std::uint64_t free = 1'000'000) {
  return {on(utc), steady, free};
}

// The same of a clock that no other one sets.
Surroundings alone(Time utc, Time steady) {
  return {utc, steady, 1'000'000, false};
}

Candidate of_day(std::int64_t id, int end, std::uint64_t bytes = 100) {
  return {id, on(end), bytes, false, false};
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
  ck_assert(retention.expired(all, limits, {on(5000) + minutes(29), minutes(30), 1000}).empty());
  ck_assert(retention.expired(all, limits, {on(100) + minutes(40), minutes(40), 1000}).empty());  // put right
  ck_assert(retention.expired(all, limits, {on(100) + hours(5), hours(5), 1000}).empty());
  ck_assert(retention.expired(all, limits, {on(106), days(6), 1000}) == Ids{1});
}
END_TEST

START_TEST(a_clock_that_stays_ahead_counts_after_an_hour) {
  Retention retention;
  const std::vector<Candidate> all = {of_day(1, 98)};
  const Limits limits{days(7), 0, 0};
  ck_assert(retention.expired(all, limits, day(100, minutes(0))).empty());
  ck_assert(retention.expired(all, limits, {on(120), minutes(1), 1000}).empty());
  ck_assert(retention.expired(all, limits, {on(120) + minutes(59), minutes(60), 1000}).empty());
  ck_assert(retention.expired(all, limits, {on(120) + minutes(60), minutes(61), 1000}) == Ids{1});
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
  ck_assert(retention.expired(all, limits, {on(100) + minutes(60), minutes(60), 1000}) == Ids{1});
}
END_TEST

START_TEST(a_deletion_that_makes_no_room_is_not_followed_by_others) {
  Retention retention;
  std::vector<Candidate> all;
  for (int k = 1; k <= 20; ++k) all.push_back(of_day(k, 99));
  const Limits limits{days(7), 0, 1000};
  const auto round = [&](int second, std::uint64_t free) {
    const Ids ids = retention.expired(all, limits, day(100, std::chrono::seconds(second), free));
    std::erase_if(all, [&](const Candidate& each) { return std::ranges::count(ids, each.id) > 0; });
    return ids.size();
  };
  ck_assert_uint_eq(round(0, 850), 2);
  ck_assert_uint_eq(round(4, 850), 0);   // it may take a moment
  ck_assert_uint_eq(round(10, 949), 0);  // of 200 bytes another program took 101
  ck_assert_uint_eq(round(59, 949), 0);
  ck_assert(retention.take_fault().empty());
  ck_assert_uint_eq(round(60, 949), 0);
  const std::string fault = retention.take_fault();
  ck_assert_msg(fault.find("retention-free") != std::string::npos, "%s", fault.c_str());
  ck_assert_uint_eq(round(659, 700), 0);
  ck_assert(retention.take_fault().empty());  // the same one
  ck_assert_uint_eq(round(660, 700), 3);      // after ten minutes it is tried again
  ck_assert_uint_eq(round(720, 700), 0);
  ck_assert_uint_eq(round(720 + 1199, 700), 0);
  ck_assert_uint_eq(round(720 + 1200, 700), 3);  // and after twenty
  ck_assert(retention.take_fault().empty());
  ck_assert_uint_eq(round(1930, 999), 1);  // this one helped: no pause
  ck_assert_uint_eq(round(1935, 1099), 0);
}
END_TEST

START_TEST(a_deletion_that_makes_room_is_followed_by_others_whatever_is_recorded_meanwhile) {
  Retention retention;
  std::vector<Candidate> all = {of_day(1, 97), of_day(2, 98), of_day(3, 99), of_day(4, 99)};
  const Limits limits{days(7), 0, 1000};
  ck_assert(retention.expired(all, limits, day(100, hours(1), 950)) == Ids{1});
  all.erase(all.begin());
  all.push_back(of_day(5, 100, 90));  // it took nearly all of the room
  ck_assert(retention.expired(all, limits, day(100, hours(1) + std::chrono::seconds(10), 960)) == Ids{2});
  ck_assert(retention.take_fault().empty());
}
END_TEST

START_TEST(room_that_comes_back_ends_the_pause) {
  Retention retention;
  std::vector<Candidate> all = {of_day(1, 97), of_day(2, 98), of_day(3, 99), of_day(4, 99)};
  const Limits limits{days(7), 0, 1000};
  ck_assert(retention.expired(all, limits, day(100, minutes(0), 950)) == Ids{1});
  all.erase(all.begin());
  ck_assert(retention.expired(all, limits, day(100, minutes(1), 950)).empty());
  ck_assert(!retention.take_fault().empty());
  ck_assert(retention.expired(all, limits, day(100, minutes(2), 1000)).empty());
  ck_assert(retention.take_fault().empty());
  ck_assert(retention.expired(all, limits, day(100, minutes(3), 950)) == Ids{2});
}
END_TEST

// Recordings of days 90, 92, 95 and 98; the clock says 2040.
START_TEST(a_clock_that_leaps_by_years_makes_no_recording_older_than_a_day_unless_it_is_synchronised) {
  const std::vector<Candidate> all = {of_day(1, 90), of_day(2, 92), of_day(3, 95), of_day(4, 98)};
  const Limits limits{days(7), 0, 0};
  const auto later = [&](Retention& retention, Time elapsed, bool synchronised) {
    Surroundings now = alone(on(5000), Time::zero());
    now.synchronised = synchronised;
    ck_assert(retention.expired(all, limits, now).empty());
    now.utc += elapsed;
    now.steady += elapsed;
    return retention.expired(all, limits, now);
  };
  const auto after = [&](Time elapsed) {
    Retention retention;
    return later(retention, elapsed, false);
  };
  // Four times without recordings, each of a day at most: 4, 3, 2 and 1 days, and what passed since the start.
  ck_assert(after(hours(2)).empty());
  ck_assert(after(days(3)).empty());
  ck_assert(after(days(3) + hours(1)) == Ids{1});
  const Ids three = {1, 2, 3};
  ck_assert(after(days(6)) == three);
  const Ids every = {1, 2, 3, 4};
  ck_assert(after(days(6) + hours(1)) == every);
  Retention synchronised;
  ck_assert(later(synchronised, hours(2), true) == every);
}
END_TEST

START_TEST(time_that_passed_while_the_recorder_ran_counts_in_full) {
  Retention retention;
  std::vector<Candidate> all = {of_day(1, 100)};
  const Limits limits{days(7), 0, 0};
  for (int k = 0; k <= 7; ++k) ck_assert(retention.expired(all, limits, alone(on(100 + k), days(k))).empty());
  all.push_back(of_day(2, 107));
  ck_assert(retention.expired(all, limits, alone(on(107) + hours(1), days(7) + hours(1))) == Ids{1});
}
END_TEST

START_TEST(a_clock_that_was_not_set_deletes_nothing_by_age) {
  Retention retention;
  const std::vector<Candidate> all = {{1, days(3), 100, false, false}, {2, days(11), 100, false, false}};
  ck_assert(retention.expired(all, {days(7), 0, 0}, {days(20), hours(1), 1000}).empty());
  ck_assert(retention.expired(all, {days(7), 0, 0}, {days(40), days(20) + hours(1), 1000}).empty());
  ck_assert(retention.expired(all, {days(7), 199, 0}, {days(40), days(20) + hours(1), 1000}) == Ids{1});
}
END_TEST

START_TEST(recordings_of_before_the_clock_was_set_are_as_old_as_the_next_one) {
  std::vector<Candidate> all = {{1, days(3), 100, false, false}, {2, days(3), 100, false, false}};
  ck_assert(Retention().expired(all, {days(7), 0, 0}, day(100)).empty());
  all.push_back(of_day(3, 93));
  all.push_back(of_day(4, 99));
  ck_assert(Retention().expired(all, {days(7), 0, 0}, day(100)).empty());
  const Ids three = {1, 2, 3};
  ck_assert(Retention().expired(all, {days(6), 0, 0}, day(100)) == three);
}
END_TEST

int main() {
  Suite* suite = suite_create("retention");
  TCase* cases = tcase_create("retention");
  for (const TTest* test :
       {what_is_older_than_the_age_is_deleted_and_what_is_as_old_is_not,
        no_limit_deletes_nothing,
        the_oldest_are_deleted_until_the_total_fits,
        the_oldest_are_deleted_until_there_is_room,
        what_is_kept_and_what_is_open_is_never_deleted,
        a_clock_that_jumps_ahead_deletes_nothing_by_age_for_an_hour,
        a_clock_that_stays_ahead_counts_after_an_hour,
        a_clock_that_falls_back_deletes_nothing_and_size_still_counts_by_order,
        room_that_deletion_cannot_make_deletes_nothing,
        kept_recordings_beyond_the_size_delete_no_other_ones,
        a_recording_is_no_older_than_those_before_it,
        a_recording_of_the_future_keeps_no_other_one,
        after_a_start_with_old_recordings_only_age_counts_after_an_hour,
        a_deletion_that_makes_no_room_is_not_followed_by_others,
        a_deletion_that_makes_room_is_followed_by_others_whatever_is_recorded_meanwhile,
        room_that_comes_back_ends_the_pause,
        a_clock_that_leaps_by_years_makes_no_recording_older_than_a_day_unless_it_is_synchronised,
        time_that_passed_while_the_recorder_ran_counts_in_full,
        a_clock_that_was_not_set_deletes_nothing_by_age,
        recordings_of_before_the_clock_was_set_are_as_old_as_the_next_one})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
