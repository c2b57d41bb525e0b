// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/event_recorder.h"

#include <check.h>

#include <algorithm>
#include <map>
#include <random>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

// A file as it was written: the presentation times of each track, in milliseconds.
struct Written {
  FileStart start;
  std::map<int, std::vector<long>> tracks;
  std::vector<bool> keyframes;
  bool closed = false;
  FileEnd end;
};

class Files final : public FileWriter {
 public:
  void open(const FileStart& start) override { all[start.file].start = start; }
  void write(std::uint32_t file, int track, const Unit& unit) override {
    ck_assert(all.contains(file) && !all[file].closed);
    all[file].tracks[track].push_back(unit.presentation / milliseconds(1));
    if (track == 0) all[file].keyframes.push_back(unit.keyframe);
  }
  void close(const FileEnd& end) override {
    ck_assert(all.contains(end.file) && !all[end.file].closed);
    all[end.file].closed = true;
    all[end.file].end = end;
  }

  std::map<std::uint32_t, Written> all;
};

Unit frame_at(Time time, bool keyframe = true, int format = 0) {
  Unit unit;
  unit.decode = unit.presentation = time;
  unit.keyframe = keyframe;
  unit.format = format;
  unit.bytes = 1000;
  return unit;
}

// One frame a second, every `gop`th a keyframe.
struct Rig {
  Rig(int gop, int pre_roll, int post_roll, int join, int longest = 0) : gop(gop), recorder(files) {
    settings.pre_roll = seconds(pre_roll);
    settings.cycle = {seconds(post_roll), seconds(join)};
    settings.longest_file = seconds(longest);
    recorder.configure(settings);
  }
  void play_to(int last) {
    for (; next <= last; ++next) recorder.push_video(frame_at(seconds(next), next % gop == 0));
  }
  const Written& file(std::uint32_t number) { return files.all.at(number); }
  // The seconds in a file; -1 if they are not consecutive.
  std::pair<long, long> span(std::uint32_t number) {
    const auto& frames = file(number).tracks.at(0);
    for (std::size_t k = 1; k < frames.size(); ++k)
      if (frames[k] != frames[k - 1] + 1000) return {-1, -1};
    return {frames.front() / 1000, frames.back() / 1000};
  }

  int gop, next = 0;
  Files files;
  EventRecorder recorder;
  EventRecorder::Settings settings;
};

using Span = std::pair<long, long>;

}  // namespace

START_TEST(an_event_holds_whole_gops_of_pre_roll_and_its_post_roll) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(21);
  rig.recorder.trigger(seconds(21), "start");  // 21 - 5 = 16: a keyframe
  rig.play_to(60);
  ck_assert_uint_eq(rig.files.all.size(), 1);
  ck_assert(rig.span(1) == Span(16, 24));
  ck_assert(rig.file(1).closed && rig.file(1).end.last);
  ck_assert(rig.file(1).end.end == seconds(24));
  ck_assert(rig.file(1).start.trigger == seconds(21));
  ck_assert_str_eq(rig.file(1).start.reason.c_str(), "start");
}
END_TEST

START_TEST(the_pre_roll_is_written_at_the_trigger_and_not_later) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(20);
  rig.recorder.trigger(seconds(20), "start");  // 15: the GOP of 12
  ck_assert(rig.span(1) == Span(12, 20));
}
END_TEST

START_TEST(an_event_at_the_start_of_the_stream_begins_with_its_first_frame) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(1);
  rig.recorder.trigger(seconds(1), "start");
  rig.play_to(30);
  ck_assert(rig.span(1) == Span(0, 4));
}
END_TEST

START_TEST(a_trigger_within_join_of_the_end_continues_the_file) {
  Rig rig(1, 2, 3, 2);
  rig.play_to(10);
  rig.recorder.trigger(seconds(10), "start");  // ends at 13
  rig.play_to(15);
  ck_assert(rig.span(1) == Span(8, 13));  // those of 14 and 15 wait
  rig.recorder.trigger(seconds(15), "again");
  rig.play_to(40);
  ck_assert_uint_eq(rig.files.all.size(), 1);
  ck_assert(rig.span(1) == Span(8, 18));
}
END_TEST

START_TEST(a_later_trigger_begins_another_file) {
  Rig rig(1, 2, 3, 2);
  rig.play_to(10);
  rig.recorder.trigger(seconds(10), "start");
  rig.play_to(20);
  rig.recorder.trigger(seconds(20), "again");
  rig.play_to(40);
  ck_assert_uint_eq(rig.files.all.size(), 2);
  ck_assert(rig.span(1) == Span(8, 13));
  ck_assert(rig.span(2) == Span(18, 23));
  ck_assert_uint_eq(rig.file(2).start.event, 2);
}
END_TEST

START_TEST(an_event_whose_pre_roll_reaches_into_the_one_before_continues_it) {
  Rig rig(10, 2, 3, 0);  // keyframes every 10 s
  rig.play_to(10);
  rig.recorder.trigger(seconds(10), "start");  // 0 to 13
  rig.play_to(18);
  rig.recorder.trigger(seconds(18), "again");  // its pre-roll would begin at 10
  rig.play_to(50);
  ck_assert_uint_eq(rig.files.all.size(), 1);
  ck_assert(rig.span(1) == Span(0, 21));
}
END_TEST

START_TEST(a_started_event_lasts_until_it_is_stopped_and_its_post_roll) {
  Rig rig(5, 2, 3, 0);
  rig.play_to(10);
  rig.recorder.start(seconds(10), "start");
  rig.play_to(100);
  ck_assert(rig.recorder.recording());
  rig.recorder.stop(seconds(100));
  rig.play_to(150);
  ck_assert(rig.span(1) == Span(5, 103));
  ck_assert(rig.file(1).closed);
}
END_TEST

START_TEST(a_long_event_is_split_at_keyframes_and_no_file_is_longer_than_allowed) {
  Rig rig(4, 2, 3, 0, 10);
  rig.play_to(8);
  rig.recorder.start(seconds(8), "start");  // from 4
  rig.play_to(30);
  rig.recorder.stop(seconds(30));
  rig.play_to(60);
  ck_assert_uint_eq(rig.files.all.size(), 4);
  ck_assert(rig.span(1) == Span(4, 11));  // the GOP of 12 would make it 12 s long
  ck_assert(rig.span(2) == Span(12, 19));
  ck_assert(rig.span(3) == Span(20, 27));
  ck_assert(rig.span(4) == Span(28, 33));
  for (std::uint32_t file = 1; file <= 4; ++file) {
    ck_assert_uint_eq(rig.file(file).start.part, file);
    ck_assert_uint_eq(rig.file(file).start.event, 1);
    ck_assert(rig.file(file).closed);
    ck_assert(rig.file(file).end.last == (file == 4));
  }
}
END_TEST

START_TEST(a_file_holds_a_whole_gop_even_if_that_is_longer_than_allowed) {
  Rig rig(20, 2, 3, 0, 10);
  rig.play_to(20);
  rig.recorder.start(seconds(20), "start");
  rig.play_to(65);
  rig.recorder.finish();
  ck_assert(rig.span(1) == Span(0, 19));
  ck_assert(rig.span(2) == Span(20, 39));
  ck_assert(rig.span(3) == Span(40, 59));
  ck_assert(rig.span(4) == Span(60, 65));
}
END_TEST

START_TEST(a_late_analysis_triggers_as_if_it_were_in_time) {
  // The analysis is 6 s behind: twice the post-roll, and more than the pre-roll.
  Rig rig(2, 4, 3, 0);
  for (int second = 0; second <= 60; ++second) {
    rig.play_to(second);
    if (second < 6) continue;
    const int analysed = second - 6;
    if (analysed == 20 || analysed == 22 || analysed == 24 || analysed == 40)
      rig.recorder.trigger(seconds(analysed), "track");
    rig.recorder.analysed(seconds(analysed));
  }
  rig.recorder.finish();
  ck_assert_uint_eq(rig.files.all.size(), 2);
  ck_assert(rig.span(1) == Span(16, 27));
  ck_assert(rig.span(2) == Span(36, 43));
  ck_assert(rig.recorder.lag() == seconds(6));
}
END_TEST

START_TEST(a_lost_analysis_neither_keeps_a_file_open_nor_the_ring_growing) {
  Rig rig(1, 2, 3, 0);
  rig.play_to(10);
  rig.recorder.analysed(seconds(10));
  rig.recorder.trigger(seconds(10), "track");
  rig.play_to(25);  // 10 s behind is 15, whose pre-roll begins with the last frame of the file
  ck_assert(!rig.file(1).closed);
  rig.play_to(26);
  ck_assert(rig.file(1).closed);
  ck_assert(rig.span(1) == Span(8, 13));
  rig.play_to(1000);
  ck_assert_uint_eq(rig.recorder.bytes(), 13 * 1000);  // 2 s of pre-roll, 10 s of lag and the newest
}
END_TEST

START_TEST(an_analysis_that_is_ahead_begins_an_event_when_the_video_is_there) {
  Rig rig(2, 2, 3, 0);
  rig.play_to(10);
  rig.recorder.trigger(seconds(20), "track");
  rig.play_to(19);
  ck_assert(rig.files.all.empty());
  rig.play_to(20);
  ck_assert(rig.span(1) == Span(18, 20));
  rig.play_to(40);
  ck_assert(rig.span(1) == Span(18, 23));
}
END_TEST

START_TEST(events_that_the_analysis_finds_far_ahead_stay_apart) {
  Rig rig(1, 2, 3, 0);
  rig.play_to(1);
  for (const int time : {10, 11, 12, 30, 33, 36, 80}) rig.recorder.trigger(seconds(time), "track");
  rig.play_to(78);
  ck_assert(rig.span(1) == Span(8, 15));
  ck_assert(rig.span(2) == Span(28, 39));
  ck_assert_uint_eq(rig.files.all.size(), 2);
  rig.recorder.finish();  // the video ends before the last trigger, and in its pre-roll
  ck_assert(rig.span(3) == Span(78, 78));
}
END_TEST

START_TEST(a_trigger_of_the_far_future_holds_no_earlier_one_up) {
  Rig rig(1, 2, 3, 0);
  rig.play_to(20);
  rig.recorder.trigger(seconds(100'000), "wrong");
  rig.recorder.trigger(seconds(30), "track");  // the analysis is ahead
  rig.recorder.trigger(seconds(20), "start");
  rig.play_to(100);
  ck_assert(rig.span(1) == Span(18, 23));
  ck_assert(rig.span(2) == Span(28, 33));
  ck_assert_str_eq(rig.file(2).start.reason.c_str(), "track");
  ck_assert_uint_eq(rig.files.all.size(), 2);
}
END_TEST

START_TEST(another_format_begins_another_file_at_its_keyframe) {
  Rig rig(1, 2, 3, 0);
  rig.play_to(10);
  rig.recorder.start(seconds(10), "start");
  rig.recorder.push_video(frame_at(seconds(11), false, 1));
  rig.recorder.push_video(frame_at(seconds(12), true, 1));
  rig.recorder.push_video(frame_at(seconds(13), false, 1));
  rig.recorder.finish();
  ck_assert(rig.span(1) == Span(8, 10));
  ck_assert(rig.span(2) == Span(12, 13));
  ck_assert_int_eq(rig.file(1).start.formats[0], 0);
  ck_assert_int_eq(rig.file(2).start.formats[0], 1);
}
END_TEST

START_TEST(the_ring_has_a_limit_in_bytes_even_without_a_second_keyframe) {
  Rig rig(1'000'000, 5, 3, 0);
  rig.settings.most_bytes = 20'000;
  rig.recorder.configure(rig.settings);
  rig.play_to(10'000);
  ck_assert_uint_le(rig.recorder.bytes(), 20'000);
}
END_TEST

START_TEST(an_open_file_goes_on_where_the_ring_has_no_room) {
  Rig rig(1'000'000, 5, 3, 0);
  rig.settings.most_bytes = 20'000;
  rig.recorder.configure(rig.settings);
  rig.play_to(3);
  rig.recorder.start(seconds(3), "start");
  rig.play_to(500);
  rig.recorder.finish();
  ck_assert(rig.span(1) == Span(0, 500));
}
END_TEST

START_TEST(a_file_that_failed_before_its_first_byte_is_begun_again_with_the_same_frames) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(21);
  rig.recorder.start(seconds(21), "start");
  ck_assert(rig.span(1) == Span(16, 21));
  rig.recorder.file_failed(1, true);
  rig.play_to(25);
  ck_assert_uint_eq(rig.files.all.size(), 1);  // a pause of 5 s
  rig.play_to(30);
  rig.recorder.finish();
  ck_assert(rig.span(2) == Span(16, 30));
  ck_assert_uint_eq(rig.file(2).start.event, 1);
  ck_assert_uint_eq(rig.file(2).start.part, 2);
}
END_TEST

START_TEST(a_file_that_failed_later_is_continued_at_the_next_keyframe) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(21);
  rig.recorder.start(seconds(21), "start");
  rig.play_to(30);
  rig.recorder.file_failed(1, false);
  rig.play_to(50);
  rig.recorder.finish();
  ck_assert(rig.span(2) == Span(32, 50));
}
END_TEST

START_TEST(the_end_of_the_stream_closes_the_file) {
  Rig rig(4, 5, 3, 10);
  rig.play_to(21);
  rig.recorder.trigger(seconds(20), "start");
  rig.recorder.finish();
  ck_assert(rig.file(1).closed && rig.file(1).end.last);
  ck_assert(rig.span(1) == Span(12, 21));
  ck_assert(!rig.recorder.active());
}
END_TEST

START_TEST(after_a_reset_nothing_of_before_is_written) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(21);
  rig.recorder.trigger(seconds(21), "start");
  rig.recorder.reset();
  ck_assert(rig.file(1).closed);
  ck_assert_uint_eq(rig.recorder.bytes(), 0);
  rig.next = 0;
  rig.play_to(2);
  rig.recorder.trigger(seconds(2), "start");
  rig.recorder.finish();
  ck_assert(rig.span(2) == Span(0, 2));
}
END_TEST

START_TEST(a_reset_forgets_the_time_of_before) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(1000);
  rig.recorder.reset();
  ck_assert(rig.recorder.newest() == Time{});
  rig.recorder.start(rig.recorder.newest(), "doorbell");  // before the first frame of the new time
  rig.next = 0;
  rig.play_to(10);
  rig.recorder.finish();
  ck_assert(rig.span(1) == Span(0, 10));
}
END_TEST

START_TEST(a_pause_after_a_failure_does_not_last_beyond_a_reset) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(1000);
  rig.recorder.start(seconds(1000), "start");
  rig.recorder.file_failed(1, true);  // another is tried at 1005
  rig.recorder.reset();
  rig.next = 0;
  rig.play_to(2);
  rig.recorder.finish();
  ck_assert(rig.span(2) == Span(0, 2));
}
END_TEST

START_TEST(a_started_event_goes_on_where_times_fall_back_and_ends_when_it_is_stopped) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(1000);
  rig.recorder.start(seconds(1000), "doorbell");
  rig.recorder.reset();
  ck_assert(rig.file(1).closed && !rig.file(1).end.last);
  ck_assert(rig.recorder.active());
  rig.next = 100;
  rig.play_to(140);
  ck_assert_uint_eq(rig.files.all.size(), 2);
  ck_assert_uint_eq(rig.file(2).start.event, 1);
  ck_assert_uint_eq(rig.file(2).start.part, 2);
  ck_assert_str_eq(rig.file(2).start.reason.c_str(), "doorbell");
  ck_assert(!rig.file(2).closed);
  rig.recorder.stop(seconds(140));
  rig.play_to(160);
  ck_assert(rig.span(2) == Span(100, 143));  // the times of before do not lengthen it
  ck_assert(rig.file(2).closed && rig.file(2).end.last);
}
END_TEST

START_TEST(an_event_of_triggers_ends_where_times_fall_back) {
  Rig rig(4, 5, 3, 0);
  rig.play_to(1000);
  rig.recorder.trigger(seconds(1000), "track");
  rig.recorder.reset();
  ck_assert(rig.file(1).closed && rig.file(1).end.last);
  rig.next = 0;
  rig.play_to(2000);
  ck_assert_uint_eq(rig.files.all.size(), 1);
}
END_TEST

START_TEST(an_analysis_whose_times_fall_back_triggers_in_the_new_time) {
  Rig rig(1, 2, 3, 0);
  rig.play_to(1000);
  rig.recorder.analysed(seconds(1000));
  rig.recorder.reset();
  // Of the old time still, behind the video's jump.
  rig.recorder.trigger(seconds(1001), "track");
  rig.recorder.analysed(seconds(1001));
  rig.next = 0;
  for (int second = 0; second <= 60; ++second) {
    rig.play_to(second);
    if (second == 20) rig.recorder.trigger(seconds(20), "track");
    rig.recorder.analysed(seconds(second));
  }
  ck_assert_uint_eq(rig.files.all.size(), 1);
  ck_assert(rig.span(1) == Span(18, 23));
}
END_TEST

START_TEST(b_frames_are_cut_in_the_order_of_decoding) {
  // I0 P3 B1 B2 | I4 P7 B5 B6 | ...: a frame a second, decoded 2 s before a P would be shown.
  Files files;
  EventRecorder recorder(files);
  EventRecorder::Settings settings;
  settings.pre_roll = seconds(3);
  settings.cycle = {seconds(2), seconds(0)};
  recorder.configure(settings);
  const int order[] = {0, 3, 1, 2};
  for (int k = 0; k < 40; ++k) {
    Unit unit = frame_at(seconds(k / 4 * 4 + order[k % 4]), k % 4 == 0);
    unit.decode = seconds(k - 2);
    recorder.push_video(std::move(unit));
    if (k == 18) recorder.trigger(seconds(16), "start");
  }
  recorder.finish();
  const Written& file = files.all.at(1);
  // From the keyframe shown at 12, which is decoded at 10: time 0 of the file. All that is decoded until 18, and so
  // all that is shown until then.
  const std::vector<long> expected = {12000, 15000, 13000, 14000, 16000, 19000, 17000, 18000, 20000};
  ck_assert(file.start.origin == seconds(10) && file.start.begin == seconds(12));
  ck_assert(file.tracks.at(0) == expected);
}
END_TEST

START_TEST(audio_begins_with_the_first_frame_and_late_audio_goes_into_the_file_of_its_time) {
  Files files;
  EventRecorder recorder(files);
  EventRecorder::Settings settings;
  settings.pre_roll = seconds(2);
  settings.cycle = {seconds(3), seconds(0)};
  settings.longest_file = seconds(8);
  recorder.configure(settings);
  recorder.set_audio_format(1, 7);
  // Frames at whole seconds, keyframes every 4; audio at the half seconds, .6 s late.
  for (int tenth = 0; tenth <= 400; ++tenth) {
    if (tenth % 10 == 0) recorder.push_video(frame_at(milliseconds(100 * tenth), tenth % 40 == 0));
    if (tenth >= 6 && (tenth - 6) % 5 == 0)
      recorder.push_audio(1, frame_at(milliseconds(100 * (tenth - 6)), true, 7));
    if (tenth == 100) recorder.start(seconds(10), "start");
    if (tenth == 250) recorder.stop(seconds(25));
  }
  recorder.finish();
  ck_assert_uint_eq(files.all.size(), 3);  // 8 to 16, 16 to 24, 24 to 28
  const long bounds[] = {8000, 16000, 24000, 28001};
  for (std::uint32_t file = 1; file <= 3; ++file) {
    std::vector<long> expected;
    for (long time = bounds[file - 1]; time < bounds[file]; time += 500) expected.push_back(time);
    ck_assert(files.all[file].tracks[1] == expected);
    ck_assert_int_eq(files.all[file].start.formats[1], 7);
  }
}
END_TEST

START_TEST(audio_without_video_does_not_pile_up) {
  Files files;
  EventRecorder recorder(files);
  for (int k = 0; k < 1000; ++k) recorder.push_audio(1, frame_at(seconds(k)));
  ck_assert_uint_le(recorder.bytes(), 16 * 1000);  // 5 s of pre-roll and 10 s of lag
}
END_TEST

// Every frame that lies within the pre-roll and the post-roll of a trigger is in exactly one file, files begin with a
// keyframe and have no holes, whatever the GOP, the triggers, and the order in which analysis and video arrive.
START_TEST(no_frame_is_lost_or_doubled_in_random_events) {
  std::mt19937 random(_i);
  const auto draw = [&](int from, int to) { return std::uniform_int_distribution<>(from, to)(random); };
  constexpr int kFrames = 4000;  // 25 a second
  const auto time_of = [](int frame) { return milliseconds(40 * frame); };
  for (int round = 0; round < 4; ++round) {
    const int gop = round == 0 ? 250 : round == 1 ? 1 : draw(1, 250);
    const bool audio = draw(0, 1), split = draw(0, 1);
    const int pre_roll = draw(0, 8000), post_roll = draw(0, 6000), join = draw(0, 4000), lag = draw(-30, 200);
    Files files;
    EventRecorder recorder(files);
    EventRecorder::Settings settings;
    settings.pre_roll = milliseconds(pre_roll);
    settings.cycle = {milliseconds(post_roll), milliseconds(join)};
    settings.longest_file = split ? seconds(draw(1, 40)) : seconds(0);
    recorder.configure(settings);
    recorder.expect_analysis();
    std::vector<int> triggers;
    for (int k = draw(1, 12); k > 0; --k) triggers.push_back(draw(0, kFrames - 1));
    const int offset = draw(0, gop - 1);
    for (int frame = std::min(0, lag); frame < kFrames + std::max(0, lag); ++frame) {
      if (frame >= 0 && frame < kFrames)
        recorder.push_video(frame_at(time_of(frame), (frame + offset) % gop == 0));
      if (audio && frame >= 0 && frame < kFrames)
        recorder.push_audio(1, frame_at(time_of(frame) + milliseconds(7)));
      const int analysed = frame - lag;
      if (analysed < 0 || analysed >= kFrames) continue;
      if (std::ranges::count(triggers, analysed)) recorder.trigger(time_of(analysed), "track");
      recorder.analysed(time_of(analysed));
    }
    recorder.finish();

    std::vector<int> times(kFrames), sounds(kFrames);
    for (const auto& [number, file] : files.all) {
      ck_assert(file.closed);
      const auto& frames = file.tracks.at(0);
      ck_assert(file.keyframes.front());
      for (std::size_t k = 0; k < frames.size(); ++k) {
        ck_assert(k == 0 || frames[k] == frames[k - 1] + 40);
        ++times[static_cast<std::size_t>(frames[k] / 40)];
      }
      if (!file.tracks.contains(1)) continue;
      for (const long time : file.tracks.at(1)) {
        ++sounds[static_cast<std::size_t>(time / 40)];
        ck_assert_int_ge(time, file.start.begin / milliseconds(1));
      }
    }
    const int first_keyframe = (gop - offset) % gop;
    for (int frame = 0; frame < kFrames; ++frame) {
      const auto index = static_cast<std::size_t>(frame);
      const bool wanted =
          frame >= first_keyframe && std::ranges::any_of(triggers, [&](int trigger) {
            return 40 * frame >= 40 * trigger - pre_roll && 40 * frame <= 40 * trigger + post_roll;
          });
      ck_assert_msg(times[index] <= 1 && (!wanted || times[index] == 1),
                    "frame %d is in %d files (seed %d round %d: GOP %d, first keyframe %d, pre-roll %d, "
                    "post-roll %d, join %d, lag %d, trigger %d)",
                    frame, times[index], _i, round, gop, first_keyframe, pre_roll, post_roll, join, lag,
                    *std::ranges::min_element(triggers));
      ck_assert_int_le(sounds[index], 1);
      if (audio && times[index] == 1 && index + 1 < times.size() && times[index + 1] == 1)
        ck_assert_msg(sounds[index] == 1, "sound %d is in %d files (seed %d round %d)", frame, sounds[index],
                      _i, round);
    }
  }
}
END_TEST

int main() {
  Suite* suite = suite_create("event recorder");
  TCase* cases = tcase_create("event recorder");
  for (const TTest* test : {an_event_holds_whole_gops_of_pre_roll_and_its_post_roll,
                            the_pre_roll_is_written_at_the_trigger_and_not_later,
                            an_event_at_the_start_of_the_stream_begins_with_its_first_frame,
                            a_trigger_within_join_of_the_end_continues_the_file,
                            a_later_trigger_begins_another_file,
                            an_event_whose_pre_roll_reaches_into_the_one_before_continues_it,
                            a_started_event_lasts_until_it_is_stopped_and_its_post_roll,
                            a_long_event_is_split_at_keyframes_and_no_file_is_longer_than_allowed,
                            a_file_holds_a_whole_gop_even_if_that_is_longer_than_allowed,
                            a_late_analysis_triggers_as_if_it_were_in_time,
                            a_lost_analysis_neither_keeps_a_file_open_nor_the_ring_growing,
                            an_analysis_that_is_ahead_begins_an_event_when_the_video_is_there,
                            events_that_the_analysis_finds_far_ahead_stay_apart,
                            a_trigger_of_the_far_future_holds_no_earlier_one_up,
                            another_format_begins_another_file_at_its_keyframe,
                            the_ring_has_a_limit_in_bytes_even_without_a_second_keyframe,
                            an_open_file_goes_on_where_the_ring_has_no_room,
                            a_file_that_failed_before_its_first_byte_is_begun_again_with_the_same_frames,
                            a_file_that_failed_later_is_continued_at_the_next_keyframe,
                            the_end_of_the_stream_closes_the_file,
                            after_a_reset_nothing_of_before_is_written,
                            a_reset_forgets_the_time_of_before,
                            a_pause_after_a_failure_does_not_last_beyond_a_reset,
                            a_started_event_goes_on_where_times_fall_back_and_ends_when_it_is_stopped,
                            an_event_of_triggers_ends_where_times_fall_back,
                            an_analysis_whose_times_fall_back_triggers_in_the_new_time,
                            b_frames_are_cut_in_the_order_of_decoding,
                            audio_begins_with_the_first_frame_and_late_audio_goes_into_the_file_of_its_time,
                            audio_without_video_does_not_pile_up})
    tcase_add_test(cases, test);
  tcase_add_loop_test(cases, no_frame_is_lost_or_doubled_in_random_events, 0, 20);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
