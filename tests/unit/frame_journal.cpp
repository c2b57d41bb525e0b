// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/frame_journal.h"

#include <check.h>

#include <map>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

class Output final : public JournalOutput {
 public:
  void write_line(std::uint32_t file, Time time, std::string_view line) override {
    lines[file] += std::string(line) + '@' + std::to_string(time / seconds(1)) + ' ';
  }
  void complete(const FileEnd& end, Findings findings) override {
    ck_assert(!completed.contains(end.file));
    completed.emplace(end.file, std::move(findings));
  }
  std::map<std::uint32_t, std::string> lines;
  std::map<std::uint32_t, Findings> completed;
};

// The note of a second: its line is the number.
Note note(int second, double score = -1, std::uint32_t track = 0) {
  Note made;
  made.time = seconds(second);
  made.line = std::to_string(second);
  if (track) made.tracks = {track};
  if (score < 0) return made;
  made.picture = std::make_shared<int>(second);
  made.score = score;
  return made;
}

FileStart start_at(std::uint32_t file, int second, std::uint32_t event = 1) {
  FileStart start;
  start.file = file;
  start.event = event;
  start.begin = start.origin = seconds(second);
  return start;
}

int second_of(const Picture& picture) {
  return *static_cast<const int*>(picture.get());
}

}  // namespace

START_TEST(lines_go_to_the_file_that_has_their_frames) {
  Output output;
  FrameJournal journal(output);
  for (int second = 0; second < 10; ++second) journal.add(note(second));
  journal.open(start_at(1, 4));
  journal.written(1, seconds(6));
  journal.advance(seconds(9), Time::min());
  ck_assert_str_eq(output.lines[1].c_str(), "4@0 5@1 6@2 ");  // 7 may be beyond its end
  journal.close({1, seconds(7), true});
  journal.advance(seconds(9), Time::min());
  ck_assert_str_eq(output.lines[1].c_str(), "4@0 5@1 6@2 7@3 ");
  ck_assert(output.completed.contains(1));
}
END_TEST

START_TEST(a_file_is_complete_once_the_analysis_has_passed_its_end) {
  Output output;
  FrameJournal journal(output);
  journal.open(start_at(1, 4));
  journal.written(1, seconds(8));
  journal.close({1, seconds(8), true});
  for (int second = 0; second < 8; ++second) {
    journal.add(note(second));
    journal.advance(seconds(second), Time::min());
  }
  ck_assert(output.completed.empty());
  journal.add(note(8));
  journal.advance(seconds(8), Time::min());
  ck_assert(output.completed.contains(1));
  ck_assert_str_eq(output.lines[1].c_str(), "4@0 5@1 6@2 7@3 8@4 ");
}
END_TEST

START_TEST(a_frame_between_the_last_one_of_a_part_and_the_next_part_belongs_to_the_former) {
  Output output;
  FrameJournal journal(output);
  journal.open(start_at(1, 0));
  journal.written(1, seconds(4));
  journal.open(start_at(2, 6));
  journal.written(2, seconds(9));
  journal.close({1, seconds(4), false});
  for (int second = 3; second < 8; ++second) journal.add(note(second));
  journal.advance(seconds(7), Time::min());
  ck_assert_str_eq(output.lines[1].c_str(), "3@3 4@4 5@5 ");
  ck_assert_str_eq(output.lines[2].c_str(), "6@0 7@1 ");
  ck_assert(output.completed.contains(1) && !output.completed.contains(2));
}
END_TEST

START_TEST(frames_between_two_events_belong_to_none) {
  Output output;
  FrameJournal journal(output);
  for (int second = 0; second < 10; ++second) journal.add(note(second));
  journal.open(start_at(1, 1, 1));
  journal.written(1, seconds(3));
  journal.close({1, seconds(3), true});
  journal.open(start_at(2, 7, 2));
  journal.written(2, seconds(8));
  journal.reset();
  ck_assert_str_eq(output.lines[1].c_str(), "1@0 2@1 3@2 ");
  ck_assert_str_eq(output.lines[2].c_str(), "7@0 8@1 ");
  ck_assert(output.completed.contains(1) && !output.completed.contains(2));
}
END_TEST

START_TEST(notes_that_come_in_the_order_of_decoding_are_written_in_that_of_time) {
  Output output;
  FrameJournal journal(output);
  journal.open(start_at(1, 0));
  journal.written(1, seconds(3));
  journal.add(note(0));
  journal.add(note(3));
  journal.advance(seconds(0), Time::min());
  journal.add(note(1));
  journal.add(note(2));
  journal.advance(seconds(3), Time::min());
  ck_assert_str_eq(output.lines[1].c_str(), "0@0 1@1 2@2 3@3 ");
}
END_TEST

START_TEST(a_file_that_failed_leaves_its_notes_to_the_one_that_begins_again) {
  Output output;
  FrameJournal journal(output);
  for (int second = 0; second < 6; ++second) journal.add(note(second));
  journal.open(start_at(1, 2));
  journal.written(1, seconds(5));
  journal.advance(seconds(5), seconds(1));
  journal.drop(1);
  journal.open(start_at(2, 2));
  journal.written(2, seconds(5));
  journal.advance(seconds(5), seconds(1));
  ck_assert_str_eq(output.lines[2].c_str(), "2@0 3@1 4@2 5@3 ");
  ck_assert(output.completed.empty());
}
END_TEST

START_TEST(findings_are_those_of_the_files_frames) {
  Output output;
  FrameJournal journal(output);
  for (int second = 0; second < 6; ++second) {
    Note each = note(second, -1, static_cast<std::uint32_t>(10 + second / 2));
    each.kinds = {second < 4 ? "person-like" : "group"};
    if (second >= 3) each.rule = "rule of " + std::to_string(second);
    journal.add(std::move(each));
  }
  journal.open(start_at(1, 2));
  journal.close({1, seconds(4), true});
  journal.advance(seconds(5), Time::min());
  const Findings& findings = output.completed.at(1);
  const std::set<std::uint32_t> tracks = {11, 12};
  const std::set<std::string_view> kinds = {"group", "person-like"};
  ck_assert(findings.tracks == tracks);
  ck_assert(findings.kinds == kinds);
  ck_assert_str_eq(findings.rule.c_str(), "rule of 3");
}
END_TEST

START_TEST(the_picture_is_that_of_the_highest_score_of_the_files_frames) {
  Output output;
  FrameJournal journal(output);
  const double scores[] = {.9, .1, .3, .2, .8, .1};  // 0 and 4 are outside
  for (int second = 0; second < 6; ++second) journal.add(note(second, scores[second]));
  journal.open(start_at(1, 1));
  journal.close({1, seconds(3), true});
  journal.advance(seconds(5), Time::min());
  ck_assert_int_eq(second_of(output.completed.at(1).picture), 2);
  ck_assert(output.completed.at(1).shown == seconds(2));
}
END_TEST

START_TEST(of_an_object_that_approaches_few_pictures_are_copied) {
  Output output;
  FrameJournal journal(output);
  journal.open(start_at(1, 0));
  int copied = 0;
  double score = .01;
  for (int second = 0; second < 1000; ++second, score *= 1.005) {  // to 147 times as much
    journal.written(1, seconds(second));
    const bool wanted = journal.wants_picture(seconds(second), score);
    copied += wanted;
    journal.add(note(second, wanted ? score : -1));
    journal.advance(seconds(second), seconds(second - 10));
  }
  // Each is 1.1 times the one before: ln 147 / ln 1.1 = 52.
  ck_assert_int_le(copied, 53);
  ck_assert_int_ge(copied, 40);
  ck_assert_uint_le(journal.pictures(), 1);
}
END_TEST

START_TEST(pictures_that_wait_for_their_file_are_few_and_the_best_ones) {
  Output output;
  FrameJournal journal(output);
  for (int tenth = 0; tenth < 600; ++tenth) {
    Note each = note(0);
    each.time = milliseconds(100 * tenth);
    each.score = tenth == 333 ? .9 : .1 + .0001 * (tenth % 10);
    if (journal.wants_picture(each.time, each.score)) each.picture = std::make_shared<int>(tenth);
    journal.add(std::move(each));
    ck_assert_uint_le(journal.pictures(), 12);
  }
  journal.open(start_at(1, 30));
  journal.close({1, seconds(40), true});
  journal.advance(seconds(60), Time::min());
  ck_assert_int_eq(second_of(output.completed.at(1).picture), 333);
}
END_TEST

START_TEST(without_an_object_one_picture_is_wanted_where_a_file_is_open) {
  Output output;
  FrameJournal journal(output);
  ck_assert(!journal.wants_picture(seconds(1), 0));
  journal.open(start_at(1, 0));
  journal.written(1, seconds(5));
  ck_assert(journal.wants_picture(seconds(1), 0));
  journal.add(note(1, 0));
  ck_assert(!journal.wants_picture(seconds(2), 0));
  journal.advance(seconds(2), Time::min());
  ck_assert(!journal.wants_picture(seconds(2), 0));
  ck_assert(journal.wants_picture(seconds(3), .1));
}
END_TEST

START_TEST(an_analysis_without_video_does_not_pile_up) {
  Output output;
  FrameJournal::Parameters parameters;
  parameters.most_bytes = 1000;
  FrameJournal journal(output, parameters);
  for (int second = 100; second < 1000; ++second) {  // lines of 3 bytes
    journal.add(note(second));
    journal.advance(seconds(second), Time::min());
  }
  ck_assert_uint_eq(journal.notes(), 333);
  journal.advance(seconds(1000), seconds(995));
  ck_assert_uint_eq(journal.notes(), 5);
}
END_TEST

int main() {
  Suite* suite = suite_create("frame journal");
  TCase* cases = tcase_create("frame journal");
  for (const TTest* test :
       {lines_go_to_the_file_that_has_their_frames, a_file_is_complete_once_the_analysis_has_passed_its_end,
        a_frame_between_the_last_one_of_a_part_and_the_next_part_belongs_to_the_former,
        frames_between_two_events_belong_to_none,
        notes_that_come_in_the_order_of_decoding_are_written_in_that_of_time,
        a_file_that_failed_leaves_its_notes_to_the_one_that_begins_again,
        findings_are_those_of_the_files_frames, the_picture_is_that_of_the_highest_score_of_the_files_frames,
        of_an_object_that_approaches_few_pictures_are_copied,
        pictures_that_wait_for_their_file_are_few_and_the_best_ones,
        without_an_object_one_picture_is_wanted_where_a_file_is_open,
        an_analysis_without_video_does_not_pile_up})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
