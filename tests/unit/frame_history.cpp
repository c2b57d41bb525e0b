// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/frame_history.h"

#include <check.h>

#include <cmath>
#include <string>

#include "support/suite.h"
#include "vision/stream_damage.h"

using namespace cerberus::vision;
using namespace std::chrono_literals;
using Time = FrameHistory::Time;

constexpr double kNominal = 0.04;
constexpr Time kStep = 40ms;

START_TEST(frames_in_order_follow_each_other) {
  FrameHistory history;
  ck_assert(history.next(0ms, kNominal).fresh);
  for (int k = 1; k < 10; ++k) {
    const FrameHistory::Step step = history.next(k * kStep, kNominal);
    ck_assert(!step.fresh);
    ck_assert(std::abs(step.seconds - 0.04) < 1e-9);
    ck_assert(step.previous == (k - 1) * kStep);
  }
}
END_TEST

START_TEST(a_dropped_history_and_time_far_back_begin_a_scene) {
  FrameHistory history;
  history.next(1s, kNominal);
  history.drop();
  FrameHistory::Step step = history.next(1s + kStep, kNominal);
  ck_assert(step.fresh);
  ck_assert(!step.broken);
  step = history.next(500ms, kNominal);
  ck_assert(step.fresh && step.broken && step.backwards);
  ck_assert(!history.next(500ms, kNominal).fresh);  // the same time again: a duplicate, no step back
}
END_TEST

// What goes wrong with timestamps while the frames themselves come as they should: frame k's, in frames.
struct Stamps {
  int (*of)(int k);
  bool backwards;
};
const Stamps kStamps[] = {
    {[](int k) { return k - (k % 10 == 9 ? 2 : 0); }, true},
    {[](int k) { return k - (k % 5 == 4 ? 2 : 0); }, true},
    // as a decoder met them: 0 3 1 2 6 4 5
    {[](int k) { return k + (k % 3 == 1 ? 2
                             : k > 0    ? -1
                                        : 0); }, true},
    {[](int k) { return 1000 - k; }, true},
    {[](int k) { return k - k / 20 * 4; }, true},  // a clock that is set back
    {[](int) { return 7; }, false},
};

START_TEST(small_steps_back_are_a_matter_of_the_timestamps_only) {
  constexpr int kFrames = 200;
  for (const Stamps& stamps : kStamps) {
    FrameHistory history;
    double sum = 0;
    bool backwards = false;
    for (int k = 0; k < kFrames; ++k) {
      const Time time = (10 + stamps.of(k)) * kStep;
      const FrameHistory::Step step = history.next(time, &stamps == &kStamps[1] ? 0 : kNominal);
      ck_assert_msg(step.fresh == (k == 0), "frame %d", k);
      ck_assert_msg(k == 0 || step.seconds > 0, "frame %d", k);
      sum += step.seconds;
      backwards = backwards || step.backwards;
    }
    ck_assert_int_eq(backwards, stamps.backwards);
    ck_assert_msg(std::abs(sum - 0.04 * (kFrames - 1)) < 0.1 * sum, "%f s", sum);
  }
}
END_TEST

// A clock that is set back once: guessed for a while, and then the new times count as the old ones did.
START_TEST(times_are_believed_again_soon_after_a_step_back) {
  FrameHistory history;
  Time time = 1s;
  for (int k = 0; k < 20; ++k) history.next(time += kStep, kNominal);
  time -= 5 * kStep;
  for (int k = 0; k < 12; ++k) {
    const FrameHistory::Step step = history.next(time += 2 * kStep / (k < 10 ? 8 : 1), kNominal);
    ck_assert(!step.fresh);
    if (k >= 10)
      ck_assert_msg(std::abs(step.seconds - 2 * kNominal) < 1e-9, "frame %d: %f s", k, step.seconds);
  }
}
END_TEST

START_TEST(times_that_no_camera_can_have_are_not_known) {
  FrameHistory history;
  history.next(0ms, kNominal);
  for (int k = 1; k < 100; ++k) {
    const FrameHistory::Step step = history.next(Time(k), kNominal);
    ck_assert(!step.fresh);
    ck_assert_msg(step.seconds == kNominal, "frame %d: %f s", k, step.seconds);
  }
}
END_TEST

START_TEST(lost_pictures_are_passed_over_unless_they_are_many) {
  for (const bool timed : {true, false})
    for (const int lost : {1, 5, 6}) {
      FrameHistory history;
      int k = 0;
      for (; k < 10; ++k) history.next(timed ? std::optional<Time>(k * kStep) : std::nullopt, kNominal);
      for (int i = 0; i < lost; ++i) history.lose();
      k += lost;
      const FrameHistory::Step step =
          history.next(timed ? std::optional<Time>(k * kStep) : std::nullopt, kNominal);
      ck_assert(step.fresh == (lost > 5));
      if (lost <= 5)
        ck_assert_msg(std::abs(step.seconds - (1 + lost) * kNominal) < 1e-9, "%f s", step.seconds);
      ck_assert(!timed || lost > 5 || step.previous == 9 * kStep);
      const FrameHistory::Step next =
          history.next(timed ? std::optional<Time>((k + 1) * kStep) : std::nullopt, kNominal);
      ck_assert_msg(std::abs(next.seconds - kNominal) < 1e-9, "%f s", next.seconds);
    }
}
END_TEST

START_TEST(a_gap_is_judged_by_the_rhythm_of_the_stream) {
  FrameHistory fast, slow, unknown;
  fast.next(0ms, kNominal);
  ck_assert(!fast.next(240ms, kNominal).fresh);  // a stall
  ck_assert(fast.next(640ms, kNominal).fresh);   // 10 frames
  slow.next(0ms, 2.0);
  ck_assert(!slow.next(2s, 2.0).fresh);  // a frame every two seconds is no gap
  ck_assert(slow.next(9s, 2.0).fresh);
  unknown.next(0ms, 0);
  ck_assert(!unknown.next(2s, 0).fresh);  // variable rate: the first distance is the rhythm
  ck_assert(!unknown.next(4s, 0).fresh);
  ck_assert(unknown.next(11s, 0).fresh);
}
END_TEST

START_TEST(a_stream_slower_than_its_caps_is_not_blind) {
  FrameHistory history;
  history.next(0ms, kNominal);
  ck_assert(history.next(1s, kNominal).fresh);
  for (int k = 2; k < 10; ++k) ck_assert(!history.next(k * 1s, kNominal).fresh);
  // and a single gap does not excuse the next one
  FrameHistory other;
  Time time{};
  other.next(time, kNominal);
  ck_assert(other.next(time += 5s, kNominal).fresh);
  ck_assert(!other.next(time += kStep, kNominal).fresh);
  ck_assert(other.next(time += 5s, kNominal).fresh);
}
END_TEST

// Frame k has the time k * kStep, but one or two of ten frames in a row are stamped far off.
START_TEST(single_times_that_are_far_off_end_no_scene) {
  for (const Time off : {Time(3h), Time(-3h), Time(11s), Time(-2s), Time(-48h)})
    for (const int count : {1, 2}) {
      FrameHistory history;
      for (int k = 100; k < 200; ++k) {
        const bool far = k % 10 >= 10 - count;
        const Time time = k * kStep + (far ? off + (k % 3) * 100ms : 0ms);
        const FrameHistory::Step step = history.next(time, kNominal);
        ck_assert_msg(step.fresh == (k == 100), "frame %d", k);
        if (k == 100) continue;
        ck_assert_msg(std::abs(step.seconds - kNominal) < 1e-9, "frame %d: %f s", k, step.seconds);
        ck_assert(step.time == k * kStep && step.previous == (k - 1) * kStep);
        ck_assert_int_eq(step.backwards, far && off < 0s);
      }
    }
}
END_TEST

// Likewise of frames that repeat a picture, of lost ones, and where the caps name no rate.
START_TEST(times_far_off_count_as_usual_around_repeated_and_lost_frames) {
  FrameHistory history;
  for (int k = 100; k < 110; ++k) history.next(k * kStep, 0);
  const auto far = history.repeat(5h, 0);
  ck_assert(std::abs(far->seconds - .04) < 1e-9 && far->time == 110 * kStep);
  ck_assert(std::abs(history.repeat(111 * kStep, 0)->seconds - .08) < 1e-9);
  FrameHistory::Step step = history.next(0s, 0);
  ck_assert(!step.fresh && std::abs(step.seconds - .12) < 1e-9 && step.time == 112 * kStep);
  history.lose();
  step = history.next(5h, 0);
  ck_assert(!step.fresh && std::abs(step.seconds - .08) < 1e-9 && step.time == 114 * kStep);
  step = history.next(115 * kStep, 0);
  ck_assert(!step.fresh && std::abs(step.seconds - .04) < 1e-9);
}
END_TEST

START_TEST(a_time_that_a_clock_confirms_is_no_outlier) {
  for (const bool confirmed : {false, true}) {
    FrameHistory history;
    for (int k = 0; k < 20; ++k) history.next(k * kStep, kNominal, false, confirmed);
    const FrameHistory::Step step = history.next(12s, kNominal, false, confirmed);
    ck_assert(step.broken == confirmed && step.time == (confirmed ? Time(12s) : 20 * kStep));
  }
  // Nor of a frame that repeats the picture before.
  for (const bool confirmed : {false, true}) {
    FrameHistory history;
    for (int k = 0; k < 20; ++k) history.next(k * kStep, kNominal);
    const auto repeated = history.repeat(12s, kNominal, false, confirmed);
    ck_assert(repeated->time == (confirmed ? Time(12s) : 20 * kStep));
    ck_assert(std::abs(repeated->seconds - (confirmed ? 11.24 : .04)) < 1e-9);
  }
}
END_TEST

// Five seconds ahead may be a gap, half a second back a step of the clock: the first ends the scene, and is seen to be wrong.
START_TEST(a_gap_that_was_none_makes_all_others_doubtful) {
  for (const Time off : {Time(5s), Time(-500ms)})
    for (const int count : {1, 2}) {
      FrameHistory history;
      int fresh = 0;
      for (int k = 100; k < 300; ++k) {
        const bool far = k % 10 >= 10 - count;
        const FrameHistory::Step step = history.next(k * kStep + (far ? off : 0s), kNominal);
        fresh += step.fresh;
        if (k < 111) continue;
        ck_assert_msg(!step.fresh && std::abs(step.seconds - kNominal) < 1e-9, "frame %d: %f s", k,
                      step.seconds);
      }
      ck_assert_int_eq(fresh, 2);
    }
}
END_TEST

// A clock that is set: the third frame is believed. Where the source marks the jump, the first is.
START_TEST(times_that_stay_far_off_begin_a_scene) {
  for (const Time off : {Time(3h), Time(-3h)}) {
    FrameHistory history, marked;
    int k = 0;
    for (; k < 10; ++k) history.next(100s + k * kStep, kNominal), marked.next(100s + k * kStep, kNominal);
    for (const int last = k + 20; k < last; ++k) {
      const Time time = 100s + off + k * kStep;
      const FrameHistory::Step step = history.next(time, kNominal);
      ck_assert_int_eq(step.fresh, k == 12);
      ck_assert(k < 12 || step.time == time);
      ck_assert_int_eq(marked.next(time, kNominal, k == 10).fresh, k == 10);
    }
  }
}
END_TEST

START_TEST(missing_timestamps_are_taken_as_evenly_spaced) {
  FrameHistory history;
  ck_assert(history.next(std::nullopt, kNominal).fresh);
  const FrameHistory::Step step = history.next(std::nullopt, kNominal);
  ck_assert(!step.fresh);
  ck_assert(step.seconds == kNominal);
  ck_assert(!history.next(1s, kNominal).fresh);
  ck_assert(!history.next(std::nullopt, kNominal).fresh);
  ck_assert(history.next(500ms, kNominal).fresh);  // backwards, seen across the frame without a time
}
END_TEST

START_TEST(missing_frames_are_told_from_a_mark_alone) {
  FrameHistory history;
  ck_assert(!history.misses_frames(0ms, kNominal));  // nothing came before
  history.next(kStep, kNominal);
  ck_assert(!history.misses_frames(2 * kStep, kNominal));
  ck_assert(history.misses_frames(3 * kStep, kNominal));
  ck_assert(!history.misses_frames(0ms, kNominal));  // backwards
  ck_assert(!history.misses_frames(std::nullopt, kNominal));
  ck_assert(!history.misses_frames(3 * kStep, 0));  // no rhythm is known
  history.next(2 * kStep, 0);
  ck_assert(!history.misses_frames(3 * kStep, 0));
  ck_assert(history.misses_frames(4 * kStep, 0));
}
END_TEST

START_TEST(a_repeated_frame_counts_from_the_last_picture) {
  FrameHistory history;
  ck_assert(!history.repeat(kStep, kNominal));  // of nothing
  history.next(0ms, kNominal);
  ck_assert(std::abs(history.repeat(kStep, kNominal)->seconds - .04) < 1e-9);
  ck_assert(std::abs(history.repeat(3 * kStep, kNominal)->seconds - .12) < 1e-9);
  ck_assert(history.previous() == 0ms);
  const FrameHistory::Step step = history.next(5 * kStep, kNominal);
  ck_assert(!step.fresh && step.previous == 0ms);
  ck_assert(std::abs(step.seconds - .2) < 1e-9);
  history.drop();
  ck_assert(!history.repeat(6 * kStep, kNominal));
}
END_TEST

// The distance of the caps, else 25 frames a second.
START_TEST(repeated_frames_without_times_are_counted) {
  FrameHistory history, unknown;
  history.next(std::nullopt, .1);
  ck_assert(std::abs(history.repeat(std::nullopt, .1)->seconds - .1) < 1e-9);
  ck_assert(std::abs(history.repeat(std::nullopt, .1)->seconds - .2) < 1e-9);
  unknown.next(std::nullopt, 0);
  ck_assert(std::abs(unknown.repeat(std::nullopt, 0)->seconds - .04) < 1e-9);
}
END_TEST

// Two pictures a second, of which something has made 25 frames: the distance of the caps.
START_TEST(a_picture_that_is_seen_to_stay_leaves_no_gap) {
  FrameHistory repeated, gaps;
  for (int k = 0; k < 5; ++k) {
    const FrameHistory::Step step = repeated.next(k * 500ms, kNominal);
    ck_assert_int_eq(step.fresh, k == 0);
    if (k > 0) ck_assert(std::abs(step.seconds - .5) < 1e-9);
    for (int again = 1; again < 12; ++again) repeated.repeat(k * 500ms + again * kStep, kNominal);
  }
  gaps.next(0ms, kNominal);
  ck_assert(gaps.next(500ms, kNominal).fresh);
}
END_TEST

START_TEST(a_long_freeze_ends_the_scene) {
  FrameHistory history;
  history.next(0ms, kNominal);
  for (int k = 1; k < 50; ++k) history.repeat(k * kStep, kNominal);
  ck_assert(history.next(50 * kStep, kNominal).fresh);  // 2 s, of which .5 s are excused
}
END_TEST

START_TEST(a_frame_may_repeat_a_picture_of_the_last_half_second) {
  FrameHistory history;
  ck_assert(!history.next(0ms, .5).repeatable);
  ck_assert(history.next(500ms, .5).repeatable);
  ck_assert(!history.next(1001ms, .5).repeatable);
}
END_TEST

START_TEST(where_times_are_out_of_order_no_frame_repeats_another) {
  FrameHistory history;
  history.next(0ms, kNominal);
  ck_assert(history.next(kStep, kNominal).repeatable);
  ck_assert(!history.next(kStep, kNominal).repeatable);
  ck_assert(!history.next(2 * kStep, kNominal).repeatable);  // for the rest of the scene
  history.drop();
  history.next(5s, kNominal);
  ck_assert(history.next(5s + kStep, kNominal).repeatable);
  ck_assert(!history.next(std::nullopt, kNominal).repeatable);
}
END_TEST

START_TEST(pictures_without_times_are_as_far_apart_as_the_repeated_frames_between_them) {
  FrameHistory history;
  history.next(std::nullopt, .1);
  history.repeat(std::nullopt, .1);
  history.repeat(std::nullopt, .1);
  ck_assert(std::abs(history.next(std::nullopt, .1).seconds - .3) < 1e-9);
  ck_assert(std::abs(history.next(std::nullopt, .1).seconds - .1) < 1e-9);
}
END_TEST

START_TEST(repeated_frames_are_not_missing) {
  FrameHistory history;
  history.next(0ms, kNominal);
  history.repeat(kStep, kNominal);
  history.repeat(2 * kStep, kNominal);
  ck_assert(!history.misses_frames(3 * kStep, kNominal));
  ck_assert(history.misses_frames(4 * kStep, kNominal));
}
END_TEST

START_TEST(damaged_pictures_of_seconds_leave_no_gap_and_no_rhythm) {
  FrameHistory history;
  for (int k = 0; k < 10; ++k) history.next(k * kStep, 0);
  for (int k = 10; k < 260; ++k) history.repeat(k * kStep, 0, true);  // ten seconds
  const FrameHistory::Step step = history.next(260 * kStep, 0);
  ck_assert(!step.fresh);
  ck_assert(std::abs(step.seconds - 251 * .04) < 1e-9);
  ck_assert(!history.next(261 * kStep, 0).fresh);
  ck_assert(history.next(268 * kStep, 0).fresh);  // .28 s: the distance across the damage is not learnt
}
END_TEST

START_TEST(repetitions_after_damage_stand_for_the_stream_no_longer_than_others) {
  for (const int repeats : {5, 50}) {
    FrameHistory history;
    int k = 0;
    for (; k < 10; ++k) history.next(k * kStep, 0);
    for (const int end = k + 50; k < end; ++k) history.repeat(k * kStep, 0, true);
    for (const int end = k + repeats; k < end; ++k) history.repeat(k * kStep, 0);
    ck_assert(history.next(k * kStep, 0).fresh == (repeats == 50));
  }
}
END_TEST

START_TEST(damage_without_end_ends_the_scene) {
  FrameHistory history;
  for (int k = 0; k < 10; ++k) history.next(k * kStep, 0);
  for (int k = 10; k < 800; ++k) history.repeat(k * kStep, 0, true);  // 31.6 s
  ck_assert(history.next(800 * kStep, 0).fresh);
}
END_TEST

// Each letter is a frame: K keyframe, P predicted, k and p the same after a loss. Expected: x where it is damaged.
START_TEST(frames_from_a_loss_to_the_next_whole_keyframe_are_damaged) {
  struct Stream {
    const char *frames, *damaged;
  };
  for (const Stream& stream :
       {Stream{"KPPPKPPP", "........"}, Stream{"kPPpPPKPpK", "...xxx..x."}, Stream{"KPkPPKPP", "..xxx..."},
        Stream{"pPKP", "...."}, Stream{"KkkK", "...."}}) {
    StreamDamage damage;
    std::string is;
    for (const char* frame = stream.frames; *frame; ++frame)
      is += damage.add({.after_loss = *frame == 'k' || *frame == 'p',
                        .keyframe = *frame == 'K' || *frame == 'k',
                        .time = (frame - stream.frames) * kStep})
                ? 'x'
                : '.';
    ck_assert_str_eq(is.c_str(), stream.damaged);
  }
}
END_TEST

START_TEST(without_keyframes_for_25_seconds_nothing_counts_as_damaged) {
  StreamDamage damage;
  damage.add({.keyframe = true, .time = 0s});
  ck_assert(damage.add({.after_loss = true, .time = 1s}));
  ck_assert(damage.add({.time = 25s}));
  ck_assert(!damage.add({.time = 25040ms}));
  ck_assert(!damage.add({.after_loss = true, .time = 26s}));
  damage.add({.keyframe = true, .time = 27s});
  ck_assert(damage.add({.after_loss = true, .time = 28s}));
  damage.begin();
  ck_assert(!damage.add({.after_loss = true, .time = 29s}));  // the mark of a stream's first frame
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "frame_history", {frames_in_order_follow_each_other,
                        a_dropped_history_and_time_far_back_begin_a_scene,
                        small_steps_back_are_a_matter_of_the_timestamps_only,
                        times_are_believed_again_soon_after_a_step_back,
                        times_that_no_camera_can_have_are_not_known,
                        lost_pictures_are_passed_over_unless_they_are_many,
                        a_gap_is_judged_by_the_rhythm_of_the_stream,
                        a_stream_slower_than_its_caps_is_not_blind,
                        single_times_that_are_far_off_end_no_scene,
                        times_far_off_count_as_usual_around_repeated_and_lost_frames,
                        times_that_stay_far_off_begin_a_scene,
                        a_time_that_a_clock_confirms_is_no_outlier,
                        a_gap_that_was_none_makes_all_others_doubtful,
                        missing_timestamps_are_taken_as_evenly_spaced,
                        missing_frames_are_told_from_a_mark_alone,
                        a_repeated_frame_counts_from_the_last_picture,
                        repeated_frames_without_times_are_counted,
                        repeated_frames_are_not_missing,
                        a_picture_that_is_seen_to_stay_leaves_no_gap,
                        a_long_freeze_ends_the_scene,
                        a_frame_may_repeat_a_picture_of_the_last_half_second,
                        where_times_are_out_of_order_no_frame_repeats_another,
                        pictures_without_times_are_as_far_apart_as_the_repeated_frames_between_them,
                        damaged_pictures_of_seconds_leave_no_gap_and_no_rhythm,
                        repetitions_after_damage_stand_for_the_stream_no_longer_than_others,
                        damage_without_end_ends_the_scene,
                        frames_from_a_loss_to_the_next_whole_keyframe_are_damaged,
                        without_keyframes_for_25_seconds_nothing_counts_as_damaged});
}
