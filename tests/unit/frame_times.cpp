// SPDX-License-Identifier: LGPL-2.1-or-later
// When frames are taken and where they are missing: times by hand.
#include "motion/frame_times.h"

#include "support/suite.h"

using namespace cerberus::motion;
using namespace std::chrono_literals;

START_TEST(a_frame_without_a_time_is_taken_when_the_last_one_ended) {
  FrameTimes times;
  ck_assert(times.taken({}) == 0s && !times.last());
  ck_assert(times.taken(3s) == 3s);
  times.add(3s, 40ms);
  ck_assert(times.taken({}) == 3040ms && *times.last() == 3s);
  ck_assert(times.taken(2s) == 2s);
  times.forget();
  ck_assert(times.taken({}) == 0s && !times.last());
}
END_TEST

START_TEST(a_gap_begins_where_the_last_frame_ended) {
  FrameTimes times;
  ck_assert(!times.gap_begin(5s));  // no frame before it
  times.add(1s, 40ms);
  ck_assert(!times.gap_begin(1s) && !times.gap_begin(1040ms));
  ck_assert(*times.gap_begin(1040ms + 1ns) == 1040ms);
  times.add(2s, 0s);  // of unknown length
  ck_assert(*times.gap_begin(3s) == 2s + 1ns);
}
END_TEST

int main() {
  return cerberus::tests::run_suite("frame_times", {a_frame_without_a_time_is_taken_when_the_last_one_ended,
                                                    a_gap_begins_where_the_last_frame_ended});
}
