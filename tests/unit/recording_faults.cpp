// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/recording_faults.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus::record;
using std::chrono::seconds;

namespace {
constexpr std::uint64_t kRoom = 100 << 20;
}

START_TEST(a_file_that_fails_is_a_fault_until_one_has_been_written_for_two_seconds) {
  RecordingFaults faults;
  ck_assert(!faults.take_change());
  faults.disk_failed("no space", seconds(100));
  ck_assert(faults.take_change() == "no space");
  ck_assert(!faults.take_change());
  faults.file_written_for(seconds(1));
  ck_assert(!faults.take_change());
  faults.disk_failed("no space", seconds(106));  // after its first bytes
  ck_assert(!faults.take_change());
  faults.file_written_for(seconds(2));
  ck_assert(faults.take_change() == "");
}
END_TEST

START_TEST(the_folder_is_tried_out_where_it_is_gone_or_nearly_full_or_the_last_file_failed) {
  RecordingFaults faults;
  ck_assert(!faults.must_try(true, kRoom, false, seconds(100)));
  ck_assert(!faults.must_try(true, std::nullopt, false, seconds(100)));
  ck_assert(faults.must_try(false, std::nullopt, false, seconds(100)));
  ck_assert(faults.must_try(true, 1000, true, seconds(100)));
  faults.disk_failed("too slow", seconds(100));
  // The next file of the event decides first, and so does one that is being written.
  ck_assert(!faults.must_try(true, kRoom, false, seconds(109)));
  ck_assert(faults.must_try(true, kRoom, false, seconds(110)));
  ck_assert(!faults.must_try(true, kRoom, true, seconds(110)));
  faults.tried("");
  ck_assert(faults.text().empty());
  ck_assert(!faults.must_try(true, kRoom, false, seconds(120)));
}
END_TEST

START_TEST(what_a_trial_found_is_tried_again_at_once) {
  RecordingFaults faults;
  faults.tried("the folder is gone");
  ck_assert(faults.take_change() == "the folder is gone");
  ck_assert(faults.must_try(true, kRoom, false, seconds(1)));
  faults.tried("");
  ck_assert(faults.take_change() == "");
}
END_TEST

START_TEST(the_index_is_a_fault_of_its_own_that_a_fault_of_files_hides) {
  RecordingFaults faults;
  faults.set_index("locked");
  ck_assert(faults.take_change() == "locked");
  faults.disk_failed("no space", seconds(1));
  ck_assert(faults.take_change() == "no space");
  faults.file_complete();
  ck_assert(faults.take_change() == "locked");
  faults.set_index("");
  ck_assert(faults.take_change() == "");
}
END_TEST

START_TEST(a_trial_of_the_folder_ends_no_fault_that_is_not_the_folder_s) {
  RecordingFaults faults;
  faults.stream_failed("the encoder failed");
  ck_assert(faults.take_change() == "the encoder failed");
  ck_assert(!faults.must_try(true, kRoom, false, seconds(1000)));
  faults.tried("no space");
  ck_assert(faults.take_change() == "no space");
  faults.tried("");
  ck_assert(faults.take_change() == "the encoder failed");
  faults.set_index("locked");
  faults.file_written_for(seconds(2));
  ck_assert(faults.take_change() == "locked");
  faults.tried("");
  ck_assert(faults.text() == "locked");
}
END_TEST

START_TEST(a_disk_that_does_not_answer_is_a_fault_after_five_seconds_and_until_it_does) {
  RecordingFaults faults;
  ck_assert(!faults.waits_too_long(seconds(100), seconds(104)));
  ck_assert(faults.waits_too_long(seconds(100), seconds(105)));
  faults.disk_failed("too slow", seconds(101));
  faults.set_silent("no answer");
  ck_assert(faults.take_change() == "no answer");
  faults.set_silent("");
  ck_assert(faults.take_change() == "too slow");
  faults.set_silent("no answer");
  faults.file_complete();
  ck_assert(faults.text() == "no answer");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "recording_faults",
      {a_file_that_fails_is_a_fault_until_one_has_been_written_for_two_seconds,
       the_folder_is_tried_out_where_it_is_gone_or_nearly_full_or_the_last_file_failed,
       what_a_trial_found_is_tried_again_at_once, the_index_is_a_fault_of_its_own_that_a_fault_of_files_hides,
       a_trial_of_the_folder_ends_no_fault_that_is_not_the_folder_s,
       a_disk_that_does_not_answer_is_a_fault_after_five_seconds_and_until_it_does});
}
