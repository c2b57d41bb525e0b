// SPDX-License-Identifier: LGPL-2.1-or-later
// Which frames are looks of a detector that attaches boxes to some of them.
#include "vision/persons/look_times.h"

#include <set>

#include "support/suite.h"

using cerberus::vision::LookTimes;

namespace {

constexpr double kFrame = 1.0 / 25;

// Numbers of the frames without boxes that are looks, of `frames`. The detector looks at every frame of `looks`.
std::set<int> missed(const std::set<int>& looks, int frames) {
  LookTimes times;
  std::set<int> found;
  for (int n = 0; n < frames; ++n) {
    const bool boxes = looks.contains(n);
    const bool look = times.is_look(n == 0 ? 0 : kFrame, boxes);
    ck_assert(look || !boxes);
    if (look && !boxes) found.insert(n);
  }
  return found;
}

}  // namespace

START_TEST(without_boxes_nothing_is_a_look) {
  ck_assert(missed({}, 1000).empty());
}
END_TEST

START_TEST(between_the_looks_of_a_slow_detector_nobody_is_missed) {
  // 2 a second: now and then a frame more or less lies between.
  ck_assert(missed({3, 15, 28, 40, 53, 65, 78}, 84).empty());
}
END_TEST

START_TEST(who_has_left_is_missed_once_an_interval) {
  const auto found = missed({0, 12, 24, 36}, 36 + 5 * 12);
  ck_assert_uint_eq(found.size(), 4);
  int before = 36;
  for (const int n : found) {
    // The first one is found late, as the look may come a little later than usual; the others then follow in time.
    const int distance = n - before;
    ck_assert_msg(distance >= 11 && distance <= (before == 36 ? 19 : 13), "%d", distance);
    before = n;
  }
}
END_TEST

START_TEST(a_detector_of_every_frame_misses_at_every_frame) {
  std::set<int> all;
  for (int n = 0; n < 10; ++n) all.insert(n);
  const auto found = missed(all, 20);
  ck_assert_uint_ge(found.size(), 9);
}
END_TEST

START_TEST(a_look_that_missed_somebody_makes_no_slow_detector_of_it) {
  const auto found = missed({0, 5, 10, 20, 25, 35}, 35 + 25);
  ck_assert_uint_ge(found.size(), 4);  // 5 frames apart
}
END_TEST

START_TEST(one_box_out_of_step_makes_no_fast_detector_of_it) {
  // The look at frame 30 has a second result.
  ck_assert(missed({0, 10, 20, 30, 31, 40, 50, 60, 70, 80}, 84).empty());
}
END_TEST

START_TEST(a_single_look_is_missed_after_a_second) {
  const auto found = missed({5}, 5 + 25 + 25);
  ck_assert_uint_eq(found.size(), 1);
  ck_assert_int_ge(*found.begin(), 5 + 25);
}
END_TEST

START_TEST(a_break_is_no_interval) {
  // A look a second, a cut .2 s after one of them, and looks as before.
  LookTimes times;
  int missed = 0;
  const auto looks = [&](int from, int to, int at) {
    for (int n = from; n < to; ++n) {
      const bool boxes = n % 25 == at;
      missed += times.is_look(kFrame, boxes) && !boxes;
    }
  };
  looks(0, 80, 0);
  times.reset();
  looks(80, 280, 5);
  ck_assert_int_eq(missed, 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "look_times", {without_boxes_nothing_is_a_look, between_the_looks_of_a_slow_detector_nobody_is_missed,
                     who_has_left_is_missed_once_an_interval, a_detector_of_every_frame_misses_at_every_frame,
                     a_look_that_missed_somebody_makes_no_slow_detector_of_it,
                     one_box_out_of_step_makes_no_fast_detector_of_it, a_single_look_is_missed_after_a_second,
                     a_break_is_no_interval});
}
