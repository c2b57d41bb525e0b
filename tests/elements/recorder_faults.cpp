// SPDX-License-Identifier: LGPL-2.1-or-later
// What keeps a recorder from recording is reported once, as `fault`, and ends with `sound`: a file that cannot be written, a
// folder that is removed, an index that another program locks, a disk that does not answer. (A full disk: recorder_full_disk.cpp.)
#include <sqlite3.h>

#include <memory>

#include "blocked_folder.h"
#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

// next_fault(), while frames come.
std::string next_fault_while_playing(Rig& rig) {
  while (rig.next < 60 * 20) {
    rig.play_to(rig.next);
    g_usleep(50000);
    while (g_autoptr(GstMessage) message = gst_bus_pop_filtered(rig.bus, GST_MESSAGE_ELEMENT)) {
      const GstStructure* facts = gst_message_get_structure(message);
      const gchar* fault = gst_structure_get_string(facts, "fault");
      if (fault) return fault;
      if (g_strcmp0(gst_structure_get_string(facts, "state"), "sound") == 0) return "sound";
    }
  }
  fail("no fault is reported");
  return "";
}

struct Database {
  sqlite3* database = nullptr;
  explicit Database(const std::string& path) {
    fail_unless_equals_int(sqlite3_open(path.c_str(), &database), SQLITE_OK);
    sqlite3_busy_timeout(database, 10000);
  }
  ~Database() { sqlite3_close(database); }
  void run(const char* sql) {
    fail_unless_equals_int(sqlite3_exec(database, sql, nullptr, nullptr, nullptr), SQLITE_OK);
  }
  int count(const char* sql) {
    sqlite3_stmt* statement = nullptr;
    fail_unless_equals_int(sqlite3_prepare_v2(database, sql, -1, &statement, nullptr), SQLITE_OK);
    fail_unless_equals_int(sqlite3_step(statement), SQLITE_ROW);
    const int count = sqlite3_column_int(statement, 0);
    sqlite3_finalize(statement);
    return count;
  }
};

}  // namespace

GST_START_TEST(a_file_that_cannot_be_written_is_a_fault_until_another_one_is) {
  Rig rig;
  rig.frame_size = 16 << 10;
  rig.start();
  rig.play_to(57);
  {
    const FileLimit limit(256 << 10);
    rig.start_event();
    rig.play_to(150);
    fault_names(rig, "takes no recordings", "File too large");
  }
  rig.play_to(400);
  fail_unless(next_fault(rig) == "sound");
}
GST_END_TEST

// Nothing in the first file plays: its frames are in the next one, and its row is marked.
GST_START_TEST(a_file_that_fails_before_anything_in_it_plays_is_marked_and_its_frames_are_in_the_next_one) {
  Rig rig;
  rig.frame_size = 200 << 10;
  rig.start();
  rig.play_to(57);
  {
    const FileLimit limit(128 << 10);  // less than a frame, more than the index
    rig.start_event();
    rig.play_to(70);
    g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  }
  rig.play_to(57 + 150);
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1-2.mp4")) == range(30, 57 + 150));
  Database index(rig.folder.path() + "/recordings.sqlite");
  fail_unless_equals_int(index.count("select broken from recordings where file = '1.mp4'"), 1);
  fail_unless_equals_int(index.count("select broken from recordings where file = '1-2.mp4'"), 0);
}
GST_END_TEST

GST_START_TEST(a_folder_that_is_removed_is_a_fault_also_while_a_file_is_written_and_its_index_begins_anew) {
  Rig rig;
  rig.start();
  rig.play_to(57);
  rig.start_event();
  rig.play_to(70);
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  std::filesystem::remove_all(rig.folder.path());
  fault_names(rig, rig.folder.path().c_str(), "No such file");
  g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  std::filesystem::create_directory(rig.folder.path());
  rig.play_to(70 + 200);
  fail_unless(next_fault(rig) == "sound");
  rig.finish();
  // The next file of the event: it plays, and is in the index that was begun anew.
  fail_if(numbers_of(read_back(rig.folder.path() + "/1-2.mp4")).empty());
  Database index(rig.folder.path() + "/recordings.sqlite");
  fail_unless_equals_int(index.count("select count(*) from recordings where file = '1-2.mp4' and open = 0"),
                         1);
}
GST_END_TEST

GST_START_TEST(a_folder_that_is_removed_while_nothing_happens_is_a_fault_until_it_is_there_again) {
  Rig rig;
  rig.start();
  rig.play_to(10);
  std::filesystem::remove_all(rig.folder.path());
  fault_names(rig, rig.folder.path().c_str(), "No such file");
  std::filesystem::create_directory(rig.folder.path());
  fail_unless(next_fault(rig) == "sound");
  fail_unless(rig.folder.files({""}).empty(), "the trial left a file");
}
GST_END_TEST

GST_START_TEST(an_index_that_is_locked_is_a_fault_and_what_is_recorded_meanwhile_is_listed_afterwards) {
  const bool at_the_start = __i__ == 1;
  Rig rig;
  {
    rig.start();
    rig.play_to(10);
    if (at_the_start) rig.stop();
  }
  Database other(rig.folder.path() + "/recordings.sqlite");
  other.run("BEGIN EXCLUSIVE");
  if (at_the_start) {
    rig.start();
    rig.next = 0;
  }
  rig.play_to(57);
  rig.start_event();
  rig.play_to(70);
  fault_names(rig, "index", "locked");
  rig.stop_event();
  rig.play_to(160);
  g_autoptr(GstStructure) ended = rig.wait_for_file("ended");
  other.run("ROLLBACK");
  fail_unless(next_fault(rig) == "sound");
  fail_unless_equals_int(other.count("select count(*) from recordings where file = '1.mp4' and open = 0"), 1);
}
GST_END_TEST

// The loop's first turn: where the disk is looked at; its second: where a file is written.
GST_START_TEST(a_disk_that_does_not_answer_is_a_fault_until_it_does_and_costs_no_frame) {
  using What = BlockedFolder::What;
  Rig rig;
  rig.start();
  rig.play_to(57);
  rig.start_event();
  rig.play_to(70);
  g_autoptr(GstStructure) started = rig.wait_for_file("started");
  blocked_folder.block(rig.folder.path(), __i__ == 0 ? What::looks : What::writes);
  const std::string fault = next_fault_while_playing(rig);
  blocked_folder.release();
  fail_unless(fault.find(rig.folder.path() + "\" does not answer") != fault.npos, "%s", fault.c_str());
  fail_unless(next_fault_while_playing(rig) == "sound");
  const guint32 last = rig.next - 1;
  rig.finish();
  fail_unless(numbers_of(read_back(rig.folder.path() + "/1.mp4")) == range(30, last));
}
GST_END_TEST

static Suite* recorder_faults_suite() {
  watch_library_log();
  Suite* suite = suite_create("recorder_faults");
  TCase* tests = tcase_create("recorder_faults");
  tcase_set_timeout(tests, 240);
  tcase_add_test(tests, a_file_that_cannot_be_written_is_a_fault_until_another_one_is);
  tcase_add_test(tests,
                 a_file_that_fails_before_anything_in_it_plays_is_marked_and_its_frames_are_in_the_next_one);
  tcase_add_test(tests,
                 a_folder_that_is_removed_is_a_fault_also_while_a_file_is_written_and_its_index_begins_anew);
  tcase_add_test(tests, a_folder_that_is_removed_while_nothing_happens_is_a_fault_until_it_is_there_again);
  tcase_add_loop_test(
      tests, an_index_that_is_locked_is_a_fault_and_what_is_recorded_meanwhile_is_listed_afterwards, 0, 2);
  tcase_add_loop_test(tests, a_disk_that_does_not_answer_is_a_fault_until_it_does_and_costs_no_frame, 0, 2);
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(recorder_faults)
