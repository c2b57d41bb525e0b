// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/frame_order.h"

#include <check.h>

#include <chrono>
#include <optional>

#include "support/suite.h"

using namespace std::chrono_literals;
using cerberus::control::FrameOrder;
using Time = FrameOrder::Time;

namespace {

constexpr Time kStep = 40ms, kFar = 3h;

// A head: the newest frame, and the clock where there is one.
struct Head {
  explicit Head(bool clock) : by_clock(clock) {}
  FrameOrder::Step frame(Time time, Time now, bool marked = false) {
    const FrameOrder::Step step = order.next({.time = time,
                                              .nominal = .04,
                                              .marked = marked,
                                              .last = newest,
                                              .now = by_clock ? std::optional(now) : std::nullopt});
    if (step.taken) newest = step.taken;
    return step;
  }
  // Frames in order, each at its time.
  void frames(int first, int count) {
    for (int k = first; k < first + count; ++k) {
      const FrameOrder::Step step = frame(k * kStep, k * kStep);
      ck_assert(step.taken == k * kStep && !step.anew);
    }
  }
  FrameOrder order;
  bool by_clock;
  std::optional<Time> newest;
};

}  // namespace

START_TEST(a_single_time_far_ahead_counts_at_the_usual_distance) {
  for (const bool clock : {false, true}) {
    Head head(clock);
    head.frames(0, 10);
    const auto step = head.frame(10 * kStep + kFar, 10 * kStep);
    ck_assert(step.taken.has_value() && !step.anew);
    ck_assert(*step.taken > 9 * kStep && *step.taken < 11 * kStep);
    head.frames(11, 10);
  }
}
END_TEST

START_TEST(a_frame_that_is_not_newer_does_not_count) {
  for (const bool clock : {false, true}) {
    Head head(clock);
    head.frames(0, 60);
    for (const int k : {59, 58, 50, 40}) ck_assert(!head.frame(k * kStep, 60 * kStep).taken);
    head.frames(60, 10);
  }
}
END_TEST

START_TEST(times_that_go_back_by_more_count_from_the_third_frame_on) {
  Head head(false);
  head.frames(1000, 10);
  for (const int k : {10, 11}) ck_assert(!head.frame(k * kStep, {}).taken);
  const auto step = head.frame(12 * kStep, {});
  ck_assert(step.taken == 12 * kStep && step.anew);
  head.frames(13, 10);
}
END_TEST

START_TEST(by_the_clock_an_old_frame_never_counts) {
  Head head(true);
  head.frames(1000, 10);
  for (int k = 10; k < 40; ++k) ck_assert(!head.frame(k * kStep, 1010 * kStep).taken);
  for (const int k : {40, 41}) ck_assert(!head.frame(k * kStep, 1010 * kStep, true).taken);
  ck_assert(head.frame(1010 * kStep, 1009 * kStep).taken == 1010 * kStep);  // a little ahead of the clock
  head.frames(1011, 10);
}
END_TEST

// The very first frame, and one that the source marks: each is believed, and blinds the head for two frames at most.
START_TEST(no_time_that_was_believed_blinds_the_head_for_more_than_two_frames) {
  for (const bool clock : {false, true})
    for (const int before : {0, 10}) {
      Head head(clock);
      head.frames(0, before);
      ck_assert(head.frame(before * kStep + kFar, before * kStep, true).taken == before * kStep + kFar);
      int left_out = 0, k = before + 1;
      for (; !head.frame(k * kStep, k * kStep).taken; ++k) ++left_out;
      ck_assert_int_le(left_out, 2);
      head.frames(k + 1, 10);
    }
}
END_TEST

START_TEST(the_third_time_far_ahead_in_a_row_is_a_new_time_from_which_they_may_come_back) {
  for (const bool clock : {false, true}) {
    Head head(clock);
    head.frames(0, 10);
    for (int k = 10; k < 12; ++k) ck_assert(head.frame(k * kStep + kFar, k * kStep).taken < 13 * kStep);
    for (int k = 12; k < 20; ++k)
      ck_assert(head.frame(k * kStep + kFar, k * kStep).taken == k * kStep + kFar);
    int left_out = 0, k = 20;
    for (; !head.frame(k * kStep, k * kStep).taken; ++k) ++left_out;
    ck_assert_int_le(left_out, 2);
    head.frames(k + 1, 10);
  }
}
END_TEST

// A camera that was away for a minute: its first frame was taken now, not 40 ms after the last one.
START_TEST(a_time_that_the_clock_has_reached_counts_after_any_pause) {
  Head head(true);
  head.frames(0, 10);
  ck_assert(head.frame(60s, 60s).taken == Time(60s));
  ck_assert(head.frame(60s + kStep, 60s + kStep).taken == 60s + kStep);
}
END_TEST

START_TEST(behind_a_gap_or_a_segment_and_after_a_flush_a_time_is_believed) {
  Head head(false);
  head.frames(0, 10);
  head.order.mark();
  ck_assert(head.frame(60s, {}).taken == Time(60s));
  ck_assert(!head.order.gap(60s, head.newest).taken);
  head.newest = head.order.gap(60s + kStep, head.newest).taken;
  ck_assert(head.newest == 60s + kStep);
  ck_assert(head.frame(90s, {}).taken == Time(90s));
  head.order.forget();
  head.newest.reset();
  ck_assert(head.frame(2s, {}).taken == Time(2s));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "frame_order",
      {a_single_time_far_ahead_counts_at_the_usual_distance, a_frame_that_is_not_newer_does_not_count,
       times_that_go_back_by_more_count_from_the_third_frame_on, by_the_clock_an_old_frame_never_counts,
       no_time_that_was_believed_blinds_the_head_for_more_than_two_frames,
       the_third_time_far_ahead_in_a_row_is_a_new_time_from_which_they_may_come_back,
       a_time_that_the_clock_has_reached_counts_after_any_pause,
       behind_a_gap_or_a_segment_and_after_a_flush_a_time_is_believed});
}
