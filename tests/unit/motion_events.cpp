// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/motion_events.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace std::chrono_literals;
using Change = MotionEvents::Change;

// Frames every 40 ms, the first at 0.
struct Stream {
  MotionEvents presence;
  MotionEvents::Time now = -40ms;
  Change next(bool present, MotionEvents::Time hold, MotionEvents::Time step = 40ms) {
    now += step;
    return presence.update(present, now, step, hold);
  }
  // At the first frame of a scene the time since the one before is unknown.
  Change scene(bool present, MotionEvents::Time hold, MotionEvents::Time gap) {
    now += gap;
    return presence.update(present, now, 0ms, hold);
  }
};

START_TEST(nothing_is_reported_before_the_first_object) {
  Stream stream;
  for (int k = 0; k < 100; ++k) ck_assert(stream.next(false, 100ms) == Change::none);
}
END_TEST

START_TEST(it_starts_once_with_the_first_object) {
  Stream stream;
  ck_assert(stream.next(true, 100ms) == Change::started);
  ck_assert(stream.next(true, 100ms) == Change::none);
}
END_TEST

START_TEST(it_ends_once_when_the_hold_is_over) {
  Stream stream;
  stream.next(true, 120ms);
  ck_assert(stream.next(false, 120ms) == Change::none);   // 40 ms
  ck_assert(stream.next(false, 120ms) == Change::none);   // 80 ms
  ck_assert(stream.next(false, 120ms) == Change::ended);  // 120 ms
  ck_assert(stream.next(false, 120ms) == Change::none);
  ck_assert(stream.next(true, 120ms) == Change::started);
}
END_TEST

START_TEST(an_object_that_comes_back_is_the_same_motion_and_the_hold_begins_anew) {
  Stream stream;
  stream.next(true, 120ms);
  for (int k = 0; k < 10; ++k) {
    ck_assert(stream.next(false, 120ms) == Change::none);
    ck_assert(stream.next(false, 120ms) == Change::none);
    ck_assert(stream.next(true, 120ms) == Change::none);
  }
}
END_TEST

START_TEST(without_a_hold_the_first_empty_frame_ends_it) {
  Stream stream;
  stream.next(true, 0ms);
  ck_assert(stream.next(false, 0ms) == Change::ended);
}
END_TEST

START_TEST(a_gap_in_the_stream_counts_as_long_as_it_was) {
  Stream stream;
  stream.next(true, 10s);
  ck_assert(stream.scene(false, 10s, 9s) == Change::none);
  ck_assert(stream.scene(false, 10s, 1s) == Change::ended);
}
END_TEST

START_TEST(time_that_runs_backwards_is_no_silence_but_a_frame) {
  Stream stream;
  stream.next(true, 120ms);
  ck_assert(stream.scene(false, 120ms, -5s) == Change::none);  // 40 ms
  ck_assert(stream.next(false, 120ms, 79ms) == Change::none);
  ck_assert(stream.next(false, 120ms, 1ms) == Change::ended);
}
END_TEST

START_TEST(what_a_frame_counts_for_is_not_what_its_stamps_say) {
  for (const MotionEvents::Time apart : {-40ms, 0ms, 1000ms}) {
    MotionEvents presence;
    const MotionEvents::Time start = 1h;
    presence.update(true, start, 40ms, 80ms);
    ck_assert(presence.update(false, start + apart, 40ms, 80ms) == Change::none);
    ck_assert(presence.update(false, start + 2 * apart, 40ms, 80ms) == Change::ended);
  }
}
END_TEST

START_TEST(without_times_the_frames_are_counted) {
  MotionEvents presence;
  ck_assert(presence.update(true, std::nullopt, 50ms, 100ms) == Change::started);
  ck_assert(presence.update(false, std::nullopt, 50ms, 100ms) == Change::none);
  ck_assert(presence.update(false, 7h, 50ms, 100ms) == Change::ended);  // 7 h after what?
}
END_TEST

START_TEST(without_any_time_there_are_25_frames_a_second) {
  for (const auto& apart :
       {std::optional<MotionEvents::Time>(), std::optional<MotionEvents::Time>(0ns),
        std::optional<MotionEvents::Time>(1ns), std::optional<MotionEvents::Time>(-40ms)}) {
    MotionEvents presence;
    std::optional<MotionEvents::Time> now;
    if (apart) now = 1h;
    presence.update(true, now, 0ms, 1s);
    for (int k = 1; k <= 25; ++k) {
      if (apart) now = *now + *apart;
      ck_assert(presence.update(false, now, 0ms, 1s) == (k < 25 ? Change::none : Change::ended));
    }
  }
}
END_TEST

START_TEST(the_end_of_the_stream_ends_it_once_with_its_time) {
  Stream stream;
  ck_assert(stream.presence.end() == Change::none);
  stream.next(true, 1s);
  stream.next(true, 1s);
  ck_assert(stream.presence.last() == MotionEvents::Time(40ms));
  ck_assert(stream.presence.end() == Change::ended);
  ck_assert(stream.presence.end() == Change::none);
}
END_TEST

START_TEST(silence_before_an_object_does_not_shorten_the_hold_after_it) {
  Stream stream;
  for (int k = 0; k < 50; ++k) stream.next(false, 120ms);
  stream.next(true, 120ms);
  ck_assert(stream.next(false, 120ms) == Change::none);
}
END_TEST

START_TEST(without_frames_motion_ends_when_the_rest_of_the_hold_is_over) {
  Stream stream;
  ck_assert(!stream.presence.ends_after(1s));
  stream.next(true, 1s);
  ck_assert(stream.presence.ends_after(1s) == 1s);
  stream.next(false, 1s);
  stream.next(false, 1s);
  ck_assert(stream.presence.ends_after(1s) == 920ms);
  stream.presence.end();
  ck_assert(!stream.presence.ends_after(1s));
}
END_TEST

START_TEST(a_frame_that_is_only_late_is_no_end) {
  Stream stream;
  stream.next(true, 0ms);
  stream.next(true, 0ms);
  ck_assert(stream.presence.ends_after(0ms) == 120ms);  // three distances of 40 ms
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "presence",
      {nothing_is_reported_before_the_first_object, it_starts_once_with_the_first_object,
       it_ends_once_when_the_hold_is_over,
       an_object_that_comes_back_is_the_same_motion_and_the_hold_begins_anew,
       without_a_hold_the_first_empty_frame_ends_it, a_gap_in_the_stream_counts_as_long_as_it_was,
       time_that_runs_backwards_is_no_silence_but_a_frame, what_a_frame_counts_for_is_not_what_its_stamps_say,
       without_times_the_frames_are_counted, without_any_time_there_are_25_frames_a_second,
       the_end_of_the_stream_ends_it_once_with_its_time,
       silence_before_an_object_does_not_shorten_the_hold_after_it,
       without_frames_motion_ends_when_the_rest_of_the_hold_is_over, a_frame_that_is_only_late_is_no_end});
}
