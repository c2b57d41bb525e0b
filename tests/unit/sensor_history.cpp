// SPDX-License-Identifier: LGPL-2.1-or-later
// Readings of one group of sensors by running time, and the snapshot of several groups.
#include "fusion/sensor_history.h"

#include <check.h>

#include "../support/suite.h"
#include "fusion/sensor_snapshot.h"

using namespace cerberus::fusion;
using namespace std::chrono_literals;

namespace {

std::shared_ptr<const SensorArray> array_of(int count, double bearing) {
  auto array = std::make_shared<SensorArray>();
  array->count = count;
  array->bearings.fill(bearing);
  array->field_of_view = 2;
  return array;
}

void append(SensorHistory& history, Time time, std::uint8_t first, std::uint8_t second) {
  const std::uint8_t values[] = {first, second};
  history.append(time, values);
}

}  // namespace

START_TEST(the_newest_reading_not_later_than_the_time_counts) {
  SensorHistory history;
  history.set_array(array_of(2, 0));
  append(history, 1s, 0, 1);
  append(history, 2s, 1, 0);
  ck_assert_int_eq(history.at(999ms).values[0], kInvalid);  // before the first one
  ck_assert_int_eq(history.at(1s).values[1], 1);
  ck_assert_int_eq(history.at(1999ms).values[1], 1);
  ck_assert_int_eq(history.at(2s).values[0], 1);
  ck_assert_int_eq(history.at(100s).values[0], 1);
  append(history, 1500ms, 0, 0);  // late by less than a second: put where it belongs
  ck_assert_int_eq(history.at(1700ms).values[1], 0);
  ck_assert_int_eq(history.at(2s).values[0], 1);
}
END_TEST

START_TEST(a_time_is_covered_when_nothing_can_come_for_it_any_more) {
  SensorHistory history;
  history.set_array(array_of(2, 0));
  ck_assert(!history.covers(0s));
  append(history, 1s, 0, 1);
  ck_assert(history.covers(1s) && !history.covers(1s + 1ns));
  history.cover(3s);  // a gap: nothing changes before
  ck_assert(history.covers(3s - 1ns) && !history.covers(3s));
  history.cover(2s);
  ck_assert(history.covers(3s - 1ns));
  history.end();
  ck_assert(history.covers(1000s));
  append(history, 4s, 0, 0);  // it goes on after all
  ck_assert(history.covers(4s) && !history.covers(5s));
}
END_TEST

START_TEST(time_that_went_back_by_more_than_a_second_begins_anew) {
  SensorHistory history;
  history.set_array(array_of(2, 0));
  append(history, 100s, 1, 1);
  append(history, 1s, 0, 0);
  ck_assert(history.covers(1s) && !history.covers(2s));
  ck_assert_int_eq(history.at(200s).values[0], 0);
  ck_assert_uint_eq(history.size(), 1);
}
END_TEST

START_TEST(missing_and_strange_values_are_invalid) {
  SensorHistory history;
  history.set_array(array_of(3, 0));
  append(history, 1s, 1, 77);
  const Reading reading = history.at(1s);
  ck_assert_int_eq(reading.values[0], 1);
  ck_assert_int_eq(reading.values[1], kInvalid);
  ck_assert_int_eq(reading.values[2], kInvalid);
}
END_TEST

START_TEST(heartbeats_do_not_fill_the_history) {
  SensorHistory history;
  history.set_array(array_of(2, 0));
  for (Time time = 0s; time < 100s; time += 100ms) append(history, time, 1, 0);
  ck_assert_uint_eq(history.size(), 2);
  ck_assert_int_eq(history.at(50s).values[0], 1);
  ck_assert(history.covers(99900ms));
}
END_TEST

START_TEST(a_snapshot_holds_the_groups_in_a_row_and_at_most_sixteen_sensors) {
  SensorSnapshot snapshot;
  SensorHistory two, many;
  two.set_array(array_of(2, 1));
  many.set_array(array_of(15, -1));
  append(two, 1s, 1, 0);
  append(many, 1s, 0, 1);
  snapshot.add(two.at(1s));
  snapshot.add(many.at(1s));
  ck_assert_uint_eq(snapshot.count, 16);
  ck_assert_int_eq(snapshot.sensors[0], 1);
  ck_assert_int_eq(snapshot.sensors[3], 1);
  ck_assert_int_eq(snapshot.sensors[4], kInvalid);
  ck_assert_double_eq(snapshot.bearings[1], 1);
  ck_assert_double_eq(snapshot.bearings[2], -1);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "sensor_history",
      {the_newest_reading_not_later_than_the_time_counts,
       a_time_is_covered_when_nothing_can_come_for_it_any_more,
       time_that_went_back_by_more_than_a_second_begins_anew, missing_and_strange_values_are_invalid,
       heartbeats_do_not_fill_the_history, a_snapshot_holds_the_groups_in_a_row_and_at_most_sixteen_sensors});
}
