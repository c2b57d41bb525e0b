// SPDX-License-Identifier: LGPL-2.1-or-later
// What keeps a recorder from recording is reported once, as `fault`, and ends with `sound`: a disk without room, a folder
// that is removed, an index that another program locks.
#include <signal.h>
#include <sqlite3.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include <memory>

#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

// The next change of what keeps recordings from being made: its text; "sound": nothing does any more.
std::string next_fault(Rig& rig) {
  while (true) {
    g_autoptr(GstMessage) message = rig.take(GST_MESSAGE_ELEMENT);
    fail_unless(message != nullptr, "no fault is reported");
    const GstStructure* facts = gst_message_get_structure(message);
    const std::string state = gst_structure_get_string(facts, "state");
    if (state == "sound") return state;
    if (state == "fault") return gst_structure_get_string(facts, "fault");
  }
}

void fault_names(Rig& rig, const char* first, const char* second) {
  const std::string text = next_fault(rig);
  fail_unless(text.find(first) != text.npos && text.find(second) != text.npos, "%s", text.c_str());
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

GST_START_TEST(a_disk_that_is_full_is_a_fault_before_an_event_needs_it_and_until_it_has_room) {
  Rig rig;
  if (mount("none", rig.folder.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
    g_print("skipped: this user may not mount a disk\n");
    return;
  }
  rig.start();
  fault_names(rig, rig.folder.path().c_str(), "No space left");
  rig.play_to(57);
  rig.start_event();
  g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  const bool mounted = mount("none", rig.folder.path().c_str(), "tmpfs", MS_REMOUNT, "size=20m") == 0;
  rig.play_to(57 + 130);
  const std::string end = next_fault(rig);
  rig.finish();
  rig.stop();
  umount(rig.folder.path().c_str());
  fail_unless(mounted && end == "sound", "%s", end.c_str());
}
GST_END_TEST

// A limit of the process stands for the disk's end, which no one notices before.
GST_START_TEST(a_file_that_cannot_be_written_is_a_fault_until_another_one_is) {
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{256 << 10, before.rlim_max};  // the test's own notes are below that
  Rig rig;
  rig.frame_size = 16 << 10;
  rig.start();
  rig.play_to(57);
  setrlimit(RLIMIT_FSIZE, &small);
  rig.start_event();
  rig.play_to(150);
  fault_names(rig, "takes no recordings", "File too large");
  setrlimit(RLIMIT_FSIZE, &before);
  rig.play_to(400);
  fail_unless(next_fault(rig) == "sound");
}
GST_END_TEST

// Nothing in the first file plays: its frames are in the next one, and its row is marked.
GST_START_TEST(a_file_that_fails_before_anything_in_it_plays_is_marked_and_its_frames_are_in_the_next_one) {
  signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  Rig rig;
  rig.frame_size = 200 << 10;
  rig.start();
  rig.play_to(57);
  const rlimit small{128 << 10, before.rlim_max};  // less than a frame, more than the index
  setrlimit(RLIMIT_FSIZE, &small);
  rig.start_event();
  rig.play_to(70);
  g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  setrlimit(RLIMIT_FSIZE, &before);
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

static Suite* recorder_faults_suite() {
  watch_library_log();
  Suite* suite = suite_create("recorder_faults");
  TCase* tests = tcase_create("recorder_faults");
  tcase_set_timeout(tests, 240);
  tcase_add_test(tests, a_disk_that_is_full_is_a_fault_before_an_event_needs_it_and_until_it_has_room);
  tcase_add_test(tests, a_file_that_cannot_be_written_is_a_fault_until_another_one_is);
  tcase_add_test(tests,
                 a_file_that_fails_before_anything_in_it_plays_is_marked_and_its_frames_are_in_the_next_one);
  tcase_add_test(tests,
                 a_folder_that_is_removed_is_a_fault_also_while_a_file_is_written_and_its_index_begins_anew);
  tcase_add_test(tests, a_folder_that_is_removed_while_nothing_happens_is_a_fault_until_it_is_there_again);
  tcase_add_loop_test(
      tests, an_index_that_is_locked_is_a_fault_and_what_is_recorded_meanwhile_is_listed_afterwards, 0, 2);
  suite_add_tcase(suite, tests);
  return suite;
}

GST_CHECK_MAIN(recorder_faults)
