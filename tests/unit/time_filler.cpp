// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/time_filler.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus::record;
using std::chrono::milliseconds;
using Result = TimeFiller::Result;

namespace {

TimeFiller::Times at(int presentation, std::optional<int> decode = {}, std::optional<int> duration = {}) {
  TimeFiller::Times times;
  times.presentation = milliseconds(presentation);
  if (decode) times.decode = milliseconds(*decode);
  if (duration) times.duration = milliseconds(*duration);
  return times;
}

}  // namespace

START_TEST(a_unit_without_a_time_follows_the_one_before_at_its_duration_the_rate_or_the_last_distance) {
  for (int way = 0; way < 3; ++way) {
    TimeFiller filler;
    if (way == 1) filler.set_distance(milliseconds(40));
    auto first = at(1000, {}, way == 0 ? std::optional(40) : std::nullopt);
    ck_assert(filler.fill(first) == Result::timed);
    if (way == 2) {
      auto second = at(1040);
      ck_assert(filler.fill(second) == Result::timed);
    }
    const milliseconds last(way == 2 ? 1040 : 1000);
    for (int k = 1; k <= 3; ++k) {
      TimeFiller::Times none;
      ck_assert(filler.fill(none) == Result::placed);
      ck_assert(none.presentation == last + k * milliseconds(40) && !none.decode);
    }
  }
}
END_TEST

START_TEST(times_of_decoding_are_filled_in_where_the_stream_has_them) {
  TimeFiller filler;
  auto first = at(120, 40, 40);
  filler.fill(first);
  TimeFiller::Times none;
  ck_assert(filler.fill(none) == Result::placed);
  ck_assert(none.decode == milliseconds(80) && none.presentation == milliseconds(160));
}
END_TEST

START_TEST(units_before_the_first_time_are_left_out_and_a_stream_in_which_none_ever_comes_is_hopeless) {
  TimeFiller filler;
  TimeFiller::Times none;
  ck_assert(!filler.lacks_times());
  for (int k = 0; k < 99; ++k) ck_assert(filler.fill(none) == Result::left_out);
  ck_assert(filler.lacks_times());
  auto first = at(1000);
  ck_assert(filler.fill(first) == Result::timed);
  ck_assert(!filler.lacks_times());
  for (int k = 0; k < 300; ++k)
    ck_assert(filler.fill(none) == Result::left_out);  // nothing tells the distance
  auto second = at(1040);
  ck_assert(filler.fill(second) == Result::timed);
  ck_assert(filler.fill(none) == Result::placed);
  filler.reset();
  for (int k = 0; k < 99; ++k) {
    none = {};
    ck_assert(filler.fill(none) == Result::left_out);
  }
  ck_assert(filler.fill(none) == Result::hopeless);
}
END_TEST

START_TEST(another_stream_knows_nothing_of_the_one_before) {
  TimeFiller filler;
  auto first = at(1000, {}, 40);
  filler.fill(first);
  filler.reset();
  TimeFiller::Times none;
  ck_assert(filler.fill(none) == Result::left_out);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "time_filler",
      {a_unit_without_a_time_follows_the_one_before_at_its_duration_the_rate_or_the_last_distance,
       times_of_decoding_are_filled_in_where_the_stream_has_them,
       units_before_the_first_time_are_left_out_and_a_stream_in_which_none_ever_comes_is_hopeless,
       another_stream_knows_nothing_of_the_one_before});
}
