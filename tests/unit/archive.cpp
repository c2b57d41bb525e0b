// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/archive.h"

#include <check.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "support/suite.h"
#include "support/temporary_folder.h"

using namespace cerberus;
using namespace cerberus::record;
namespace fs = std::filesystem;
using std::chrono::days;
using std::chrono::hours;

namespace {

// Day 850 is the beginning of 2025.
constexpr Time on(int day) {
  return days(19239 + day);
}
constexpr Surroundings kNow{on(1000), hours(1), 1 << 30};

// An archive of a folder of its own.
struct Rig {
  Rig() { open(); }
  void open(const Limits& limits = {}) {
    archive.open({folder.path, "index.sqlite", limits}, kNow);
    complaints = archive.take_complaints();
  }
  // A recording of so many bytes and 10 of JSON, which ended on a day.
  Recording record(const std::string& name, int day, std::size_t bytes = 100) {
    Recording row = begin(name, day);
    write(row.file, bytes);
    archive.finish(row, file);
    file.close();
    written_on(row.file, day);
    return row;
  }
  // The same, not closed.
  Recording begin(const std::string& name, int day) {
    Recording row;
    row.begin = row.end = on(day);
    ck_assert((archive.begin(row, name, ".mp4", file)).empty());
    OpenFile lines;
    ck_assert_int_eq(archive.add_lines(row, lines), 0);
    ck_assert_int_eq(lines.write("{\"a\":100}\n", 10), 0);
    return row;
  }
  // When it was written, by the system's clock.
  void written_on(const std::string& name, int day) const {
    const timespec then{on(day) / std::chrono::seconds(1), 0}, times[] = {then, then};
    ck_assert_int_eq(utimensat(AT_FDCWD, (folder.path + '/' + name).c_str(), times, 0), 0);
  }
  void write(const std::string& name, std::size_t bytes) const {
    std::ofstream(folder.path + '/' + name) << std::string(bytes, 'x');
  }
  bool has(const std::string& name) const { return fs::exists(folder.path + '/' + name); }
  std::unique_ptr<Index> index() const {
    auto index = std::make_unique<Index>();
    bool damaged = false;
    ck_assert((index->open(folder.path + "/index.sqlite", damaged)).empty());
    return index;
  }
  std::vector<Recording> rows() const {
    std::vector<Recording> read;
    ck_assert((index()->read(read)).empty());
    return read;
  }

  TemporaryFolder folder;
  Archive archive;
  OpenFile file;
  std::vector<std::string> complaints;
};

using Names = std::vector<std::string>;

bool folder_has(const TemporaryFolder& folder, const std::string& name) {
  return fs::exists(folder.path + '/' + name);
}

}  // namespace

START_TEST(a_recording_has_its_files_and_a_row_that_is_open_until_it_is_finished) {
  Rig rig;
  Recording row = rig.begin("a/b", 999);
  ck_assert(rig.has("a/b.mp4") && rig.has("a/b.jsonl"));
  ck_assert(rig.rows().at(0).open);
  rig.write("a/b.mp4", 500);
  rig.archive.finish(row, rig.file);
  const Recording closed = rig.rows().at(0);
  ck_assert(!closed.open);
  ck_assert_uint_eq(closed.bytes, 510);
  ck_assert_str_eq(closed.lines.c_str(), "a/b.jsonl");
  struct stat about{};
  for (const char* name : {"/a/b.mp4", "/a/b.jsonl"}) {
    ck_assert_int_eq(stat((rig.folder.path + name).c_str(), &about), 0);
    ck_assert_int_eq(about.st_mode & 0777 & ~0640, 0);
  }
}
END_TEST

START_TEST(a_name_that_is_taken_in_the_folder_or_the_index_gets_a_number) {
  Rig rig;
  rig.write("a.jpg", 1);
  ck_assert(rig.record("a", 999).file == "a~1.mp4");
  ck_assert(rig.record("a", 999).file == "a~2.mp4");
  fs::remove(rig.folder.path + "/a~2.mp4");
  fs::remove(rig.folder.path + "/a~2.jsonl");  // the row is there
  ck_assert(rig.record("a", 999).file == "a~3.mp4");
}
END_TEST

START_TEST(names_that_lead_out_of_the_folder_are_refused) {
  Rig rig;
  const TemporaryFolder outside;
  fs::create_directory_symlink(outside.path, rig.folder.path + "/link");
  fs::create_symlink(outside.path + "/there.mp4", rig.folder.path + "/file.mp4");
  for (const std::string name : {"../a", "/tmp/a", "a/../../b", "link/a", "a//b", "a/./b"}) {
    Recording row;
    ck_assert_msg(!rig.archive.begin(row, name, ".mp4", rig.file).empty(), "\"%s\" was made", name.c_str());
  }
  ck_assert(fs::is_empty(outside.path));
  ck_assert(rig.record("file", 999).file == "file~1.mp4");  // through the link nothing is written
  ck_assert(fs::is_empty(outside.path));
  ck_assert_uint_eq(rig.rows().size(), 1);
}
END_TEST

START_TEST(a_folder_that_is_gone_is_not_made) {
  Rig rig;
  fs::rename(rig.folder.path, rig.folder.path + "-away");
  Recording row;
  const std::string fault = rig.archive.begin(row, "a", ".mp4", rig.file);
  ck_assert(fault.find(rig.folder.path) != std::string::npos);
  ck_assert(!fs::exists(rig.folder.path));
  fs::rename(rig.folder.path + "-away", rig.folder.path);
}
END_TEST

START_TEST(retention_deletes_file_lines_picture_and_row_together_and_empty_folders) {
  Rig rig;
  rig.record("old/a", 990);
  Recording kept = rig.record("old/b", 990);
  rig.record("new/c", 999);
  rig.write("old/a.jpg", 5);
  ck_assert((rig.archive.keep(rig.folder.path + "/old/b.mp4", true)).empty());
  const Names expected = {"old/a.mp4"};
  ck_assert(rig.archive.retain(kNow) == expected);
  ck_assert(!rig.has("old/a.mp4") && !rig.has("old/a.jsonl") && !rig.has("old/a.jpg"));
  ck_assert(rig.has("old/b.mp4") && rig.has("old/b.jsonl") && rig.has("new/c.mp4"));
  ck_assert_uint_eq(rig.rows().size(), 2);
  ck_assert((rig.archive.keep("old/b.mp4", false)).empty());
  ck_assert_uint_eq(rig.archive.retain(kNow).size(), 1);
  ck_assert(!rig.has("old") && rig.has("new"));
}
END_TEST

START_TEST(the_start_says_what_it_deletes) {
  Rig rig;
  rig.record("old", 900);
  rig.record("new", 999);
  ck_assert(rig.archive.open({rig.folder.path, "index.sqlite", {}}, kNow) == Names{"old.mp4"});
}
END_TEST

START_TEST(the_age_of_a_recording_is_not_that_of_a_camera_whose_clock_is_wrong) {
  Rig rig;
  rig.record("fresh", 1);
  rig.record("old", 2);
  rig.written_on("fresh.mp4", 999);
  rig.written_on("old.mp4", 990);
  rig.record("last", 999);
  ck_assert(rig.archive.retain(kNow).empty());  // "old" is younger than "fresh", which is of day 999
  rig.written_on("fresh.mp4", 991);
  const Names expected = {"fresh.mp4", "old.mp4"};
  ck_assert(rig.archive.retain(kNow) == expected);
}
END_TEST

START_TEST(a_recording_that_is_being_written_is_not_deleted) {
  Rig rig;
  rig.begin("a", 900);
  rig.record("b", 999);
  rig.record("c", 999);
  rig.archive.set_limits({days(7), 1, 0});
  ck_assert(rig.archive.retain(kNow) == Names{"b.mp4"});
  ck_assert(rig.has("a.mp4") && rig.has("c.mp4"));  // the newest stays
}
END_TEST

START_TEST(what_a_killed_process_left_is_closed_with_what_is_there) {
  Rig rig;
  rig.record("closed", 999);
  const Recording open = rig.begin("open", 999);
  rig.write("open.mp4", 300);
  rig.begin("empty", 999);  // closes the lock of the one before, as the end of a process does
  rig.file.close();
  rig.open();
  // It holds no frame that could be played.
  ck_assert_uint_eq(rig.complaints.size(), 1);
  ck_assert(rig.complaints[0].find("open.mp4\" was cut off") != std::string::npos);
  const auto rows = rig.rows();
  ck_assert_uint_eq(rows.size(), 2);
  ck_assert_str_eq(rows[1].file.c_str(), "open.mp4");
  ck_assert(rows[1].broken && !rows[0].broken);
  ck_assert_str_eq(rows[1].lines.c_str(), "open.jsonl");
  ck_assert(!rows[1].open && rows[1].end > open.begin);
  ck_assert_uint_eq(rows[1].bytes, 310);
  ck_assert(!rig.has("empty.mp4") && !rig.has("empty.jsonl"));
}
END_TEST

START_TEST(what_another_recorder_is_writing_is_left_alone) {
  Rig rig;
  rig.begin("open", 999);
  Archive other;
  other.open({rig.folder.path, "index.sqlite", {}}, kNow);
  ck_assert(rig.rows().at(0).open);
  ck_assert(rig.has("open.mp4"));
}
END_TEST

START_TEST(a_row_whose_file_is_gone_is_removed_with_what_is_beside_it) {
  Rig rig;
  rig.record("a", 999);
  rig.record("b", 999);
  fs::remove(rig.folder.path + "/a.mp4");
  rig.open();
  ck_assert(!rig.has("a.jsonl"));
  ck_assert_uint_eq(rig.rows().size(), 1);
}
END_TEST

START_TEST(an_open_row_without_a_file_is_removed_alone_because_its_recorder_may_be_making_the_file) {
  Rig rig;
  rig.record("closed", 999);
  Recording row;
  row.file = "b.mp4";
  row.begin = row.end = on(999);
  bool taken = false;
  ck_assert((rig.index()->add(row, taken)).empty());
  rig.write("b.jsonl", 10);
  rig.open();
  ck_assert_uint_eq(rig.rows().size(), 1);
  ck_assert(rig.has("b.jsonl"));
}
END_TEST

START_TEST(rows_of_recordings_whose_disk_is_away_are_added_when_it_is_back) {
  Rig rig;
  const TemporaryFolder other;
  const std::string index = other.path + "/index.sqlite", away = rig.folder.path + ".away";
  fs::create_directory(index);  // it cannot be opened
  rig.archive.open({rig.folder.path, index, {}}, kNow);
  rig.record("a", 999);
  fs::remove(index);
  fs::rename(rig.folder.path, away);
  Surroundings now = kNow;
  now.steady += std::chrono::minutes(1);
  rig.archive.retain(now);
  fs::create_directory(rig.folder.path);  // where the disk belongs
  rig.archive.retain(now);
  fs::remove(rig.folder.path);
  fs::rename(away, rig.folder.path);
  rig.archive.retain(now);
  Index read;
  bool damaged = false;
  std::vector<Recording> rows;
  ck_assert((read.open(index, damaged)).empty());
  ck_assert((read.read(rows)).empty());
  ck_assert_uint_eq(rows.size(), 1);
}
END_TEST

START_TEST(rows_stay_where_no_file_is_there_because_a_disk_is_not_mounted) {
  Rig rig;
  rig.record("a", 999);
  rig.record("b", 999);
  for (const char* name : {"/a.mp4", "/b.mp4"})
    fs::rename(rig.folder.path + name, rig.folder.path + name + ".away");
  rig.open();
  ck_assert_uint_eq(rig.complaints.size(), 1);
  ck_assert_uint_eq(rig.rows().size(), 2);
}
END_TEST

START_TEST(rows_stay_where_no_file_is_there_even_if_one_was_open_and_others_are_old) {
  Rig rig;
  rig.record("old", 900);
  rig.record("new", 999);
  rig.begin("open", 999);
  rig.file.close();
  for (const char* name : {"/old.mp4", "/new.mp4", "/open.mp4"})
    fs::rename(rig.folder.path + name, rig.folder.path + name + ".away");
  rig.open({days(7), 1, std::uint64_t{1} << 60});
  ck_assert_uint_eq(rig.complaints.size(), 1);
  ck_assert_uint_eq(rig.rows().size(), 3);
}
END_TEST

START_TEST(retention_leaves_the_row_of_a_file_that_is_not_there) {
  Rig rig;
  rig.record("away", 900);
  rig.record("old", 901);
  rig.record("new", 999);
  fs::remove(rig.folder.path + "/away.mp4");  // its disk was unmounted while the recorder runs
  ck_assert(rig.archive.retain(kNow) == Names{"old.mp4"});
  ck_assert_uint_eq(rig.rows().size(), 2);
}
END_TEST

START_TEST(nothing_is_deleted_where_the_folder_cannot_be_reached) {
  Rig rig;
  rig.record("old", 900);
  ck_assert(rig.archive.retain({kNow.utc, kNow.steady, std::nullopt}).empty());
  ck_assert(rig.has("old.mp4"));
}
END_TEST

START_TEST(files_of_others_are_never_touched_whatever_the_index_says) {
  Rig rig;
  const TemporaryFolder outside;
  std::ofstream(outside.path + "/precious.mp4") << "x";
  rig.write("notes.txt", 10);
  rig.write("film.mp4", 10);  // without a row
  rig.record("a", 998);
  rig.record("b", 999);
  {
    Index index;
    bool damaged = false, taken = false;
    ck_assert((index.open(rig.folder.path + "/index.sqlite", damaged)).empty());
    for (const std::string& name : {"../" + fs::path(outside.path).filename().string() + "/precious.mp4",
                                    outside.path + "/precious.mp4", std::string("notes.txt")}) {
      Recording row;
      row.file = name;
      row.open = false;
      row.begin = row.end = on(1);
      ck_assert((index.add(row, taken)).empty());
    }
    Recording row;
    row.file = "c.mp4";
    row.lines = "notes.txt";  // another file's name in a row of ours
    row.begin = row.end = on(1);
    ck_assert((index.add(row, taken)).empty());
  }
  rig.archive.retain(kNow);
  rig.open({days(7), 1, 0});  // everything is too much
  ck_assert(fs::exists(outside.path + "/precious.mp4"));
  ck_assert(rig.has("notes.txt") && rig.has("film.mp4"));
  ck_assert(!rig.has("a.mp4") && rig.has("b.mp4"));
  ck_assert_uint_eq(rig.rows().size(), 1);
  ck_assert_uint_ge(rig.complaints.size(), 1);
}
END_TEST

START_TEST(a_damaged_index_is_put_aside_and_recording_goes_on) {
  Rig rig;
  rig.record("a", 999);
  rig.archive.close();
  rig.write("index.sqlite", 5000);
  rig.open();
  ck_assert_uint_eq(rig.complaints.size(), 1);
  ck_assert(rig.complaints[0].find("index.sqlite.damaged") != std::string::npos);
  ck_assert(rig.has("index.sqlite.damaged") && rig.has("a.mp4"));
  rig.record("b", 999);
  ck_assert_uint_eq(rig.rows().size(), 1);
}
END_TEST

START_TEST(every_damaged_index_is_put_aside_under_a_name_of_its_own_with_its_journal) {
  Rig rig;
  for (const char* aside : {"index.sqlite.damaged", "index.sqlite.damaged~1"}) {
    rig.archive.close();
    rig.write("index.sqlite", 5000);
    rig.write("index.sqlite-wal", 77);
    rig.open();
    ck_assert_uint_eq(rig.complaints.size(), 1);
    ck_assert(rig.complaints[0].find(std::string(aside) + '"') != std::string::npos);
    ck_assert_uint_eq(fs::file_size(rig.folder.path + '/' + aside), 5000);
    ck_assert_uint_eq(fs::file_size(rig.folder.path + '/' + aside + "-wal"), 77);
  }
  rig.record("b", 999);
  ck_assert_uint_eq(rig.rows().size(), 1);
}
END_TEST

START_TEST(a_deletion_that_fails_is_reported_once_and_the_row_stays) {
  Rig rig;
  rig.record("old/a", 900);
  rig.record("b", 999);
  const std::string old = rig.folder.path + "/old";
  // Root may delete everything, so that another user does it.
  constexpr uid_t kNobody = 65534;
  const bool root = geteuid() == 0;
  if (root)
    for (const std::string& each : {rig.folder.path, old})
      ck_assert(chown(each.c_str(), kNobody, kNobody) == 0);
  chmod(old.c_str(), 0500);
  ck_assert(!root || seteuid(kNobody) == 0);
  for (int k = 0; k < 3; ++k) ck_assert(rig.archive.retain(kNow).empty());
  ck_assert(!root || seteuid(0) == 0);
  ck_assert_uint_eq(rig.archive.take_complaints().size(), 1);
  ck_assert_uint_eq(rig.rows().size(), 2);
  chmod(old.c_str(), 0700);
}
END_TEST

START_TEST(without_an_index_files_are_made_all_the_same_and_nothing_is_deleted) {
  const TemporaryFolder folder;
  Archive archive;
  archive.open({folder.path, "", {Time(1), 1, 0}}, kNow);
  Recording row;
  OpenFile file;
  ck_assert((archive.begin(row, "a", ".mkv", file)).empty());
  ck_assert_int_eq(file.write("x", 1), 0);
  archive.finish(row, file);
  ck_assert(archive.retain(kNow).empty());
  ck_assert(archive.take_complaints().empty());
  ck_assert(fs::exists(folder.path + "/a.mkv"));
  ck_assert(!(archive.keep("a.mkv", true)).empty());
}
END_TEST

START_TEST(an_index_that_can_be_opened_later_gets_the_rows_of_what_was_recorded_meanwhile) {
  Rig rig;
  rig.archive.close();
  fs::remove(rig.folder.path + "/index.sqlite");
  fs::create_directory(rig.folder.path + "/index.sqlite");  // it cannot be opened, and is no damaged one
  rig.open();
  ck_assert_uint_eq(rig.complaints.size(), 1);
  rig.record("a", 999);
  rig.record("old", 900);
  Recording open = rig.begin("b", 999);
  rig.write("b.mp4", 7);
  Surroundings now = kNow;
  const auto retain_after = [&](Time pause) {
    now.steady += pause;
    return rig.archive.retain(now);
  };
  ck_assert(retain_after(std::chrono::seconds(10)).empty());
  ck_assert(rig.archive.take_complaints().empty());  // the same one
  fs::remove(rig.folder.path + "/index.sqlite");
  ck_assert(retain_after(std::chrono::seconds(9)).empty());  // it is tried every 10 s
  ck_assert(!rig.has("index.sqlite"));
  ck_assert(retain_after(std::chrono::seconds(1)).empty());
  ck_assert_uint_eq(rig.rows().size(), 2);
  ck_assert_uint_eq(rig.rows()[0].bytes, 110);
  rig.archive.finish(open, rig.file);
  ck_assert_uint_eq(rig.rows().size(), 3);
  ck_assert(rig.rows()[2].file == "b.mp4" && !rig.rows()[2].open);
}
END_TEST

START_TEST(a_recording_that_another_program_keeps_during_retention_is_not_deleted) {
  Rig rig;
  rig.record("a", 990);
  rig.record("b", 999);
  // What retention does with a row that it found to be too old, after `keep` was set.
  const auto id = rig.rows()[0].id;
  ck_assert((rig.index()->set_keep("a.mp4", true)).empty());
  bool called = false, removed = true;
  const auto remove = [&] { return called = true; };
  ck_assert((rig.index()->remove_with(id, remove, removed)).empty());
  ck_assert(!called && !removed);
  ck_assert_uint_eq(rig.rows().size(), 2);
  ck_assert((rig.index()->set_keep("a.mp4", false)).empty());
  // Nor can it be set any more between the decision and the row's end.
  sqlite3* other = nullptr;
  ck_assert_int_eq(sqlite3_open((rig.folder.path + "/index.sqlite").c_str(), &other), SQLITE_OK);
  int late = SQLITE_OK;
  const auto keep_late = [&] {
    late = sqlite3_exec(other, "UPDATE recordings SET keep = 1", nullptr, nullptr, nullptr);
    return true;
  };
  ck_assert((rig.index()->remove_with(id, keep_late, removed)).empty());
  sqlite3_close(other);
  ck_assert_int_eq(late, SQLITE_BUSY);
  ck_assert(removed);
  ck_assert_uint_eq(rig.rows().size(), 1);
  ck_assert((rig.index()->remove_with(id, remove, removed)).empty());  // another recorder did it
  ck_assert(!removed && !called);
}
END_TEST

START_TEST(files_that_cannot_be_deleted_leave_the_row_as_it_is) {
  Rig rig;
  const auto id = rig.record("a", 990).id;
  bool removed = true;
  ck_assert((rig.index()->remove_with(id, [] { return false; }, removed)).empty());
  ck_assert(!removed);
  ck_assert_uint_eq(rig.rows().size(), 1);
}
END_TEST

START_TEST(a_file_that_is_being_made_is_not_taken_for_what_a_killed_process_left) {
  const TemporaryFolder folder;
  const Folder ours(folder.path);
  std::atomic<bool> over{false};
  std::thread other([&] {  // deletes each file that is not locked, as reconciliation does with empty ones
    OpenFile file;
    while (!over) {
      if (ours.lock("a.mp4", file) == 0) ours.remove("a.mp4");
      file.close();
    }
  });
  int lost = 0, made = 0;
  for (int k = 0; k < 3000; ++k) {
    OpenFile file;
    if (ours.create("a.mp4", file) != 0) continue;
    ++made;
    lost += !ours.exists("a.mp4");
    ours.remove("a.mp4");
  }
  over = true;
  other.join();
  ck_assert_int_gt(made, 0);
  ck_assert_int_eq(lost, 0);
}
END_TEST

// Two recorders begin, complete, keep and delete in one folder at once, and each starts anew again and again: nothing that
// is being written is taken for what a killed process left, and files and rows stay the same set.
START_TEST(two_recorders_and_their_retention_in_one_folder_lose_nothing) {
  const TemporaryFolder folder;
  constexpr int kRounds = 16;
  // Returns what is wrong: checks are of the test's own thread. On a slow machine an index may be locked for longer
  // than it is waited for: then it is tried again.
  const auto record = [&folder](char name) {
    std::string wrong;
    Archive archive;
    const auto locked = [&] {
      bool found = false;
      for (const std::string& text : archive.take_complaints()) {
        const bool only_locked = text.find("database is locked") != std::string::npos;
        found |= only_locked;
        if (!only_locked) wrong += text + "; ";
      }
      return found;
    };
    const auto check = [&](bool good, const char* what) {
      if (!good) wrong += std::string(what) + "; ";
    };
    for (int k = 0; k < kRounds; ++k) {
      do {
        if (k % 3 == 0) archive.open({folder.path, "index.sqlite", {days(7), 300, 0}}, kNow);
      } while (locked());
      Recording row;
      OpenFile file, lines;
      row.begin = row.end = on(999);
      wrong += archive.begin(row, std::string(1, name) + "/" + std::to_string(k), ".mp4", file);
      check(archive.add_lines(row, lines) == 0, "lines cannot be made");
      check(file.write("0123456789", 10) == 0 && lines.write("0123456789", 10) == 0, "write");
      check(folder_has(folder, row.file), "a file was deleted while it was written");
      row.tracks = "7";
      archive.finish(row, file);
      file.close();
      do archive.retain(kNow);
      while (locked());
    }
    return wrong;
  };
  std::string wrong_of_other;
  std::thread other([&] { wrong_of_other = record('b'); });
  const std::string wrong = record('a');
  other.join();
  ck_assert_str_eq(wrong.c_str(), "");
  ck_assert_str_eq(wrong_of_other.c_str(), "");
  Index index;
  bool damaged = false;
  std::vector<Recording> rows;
  ck_assert((index.open(folder.path + "/index.sqlite", damaged)).empty());
  ck_assert((index.read(rows)).empty());
  std::size_t files = 0;
  for (const auto& each : fs::recursive_directory_iterator(folder.path))
    files += each.path().extension() == ".mp4";
  ck_assert_uint_eq(files, rows.size());
  ck_assert_uint_ge(rows.size(), 15);  // of 20 bytes each: the last retention leaves 300
  for (const Recording& row : rows) {
    ck_assert(folder_has(folder, row.file) && folder_has(folder, row.lines));
    ck_assert_msg(!row.open && row.tracks == "7" && row.bytes == 20, "%s", row.file.c_str());
  }
}
END_TEST

int main() {
  Suite* suite = suite_create("archive");
  TCase* cases = tcase_create("archive");
  for (const TTest* test :
       {a_recording_has_its_files_and_a_row_that_is_open_until_it_is_finished,
        a_name_that_is_taken_in_the_folder_or_the_index_gets_a_number,
        names_that_lead_out_of_the_folder_are_refused,
        a_folder_that_is_gone_is_not_made,
        retention_deletes_file_lines_picture_and_row_together_and_empty_folders,
        the_start_says_what_it_deletes,
        the_age_of_a_recording_is_not_that_of_a_camera_whose_clock_is_wrong,
        a_recording_that_is_being_written_is_not_deleted,
        what_a_killed_process_left_is_closed_with_what_is_there,
        what_another_recorder_is_writing_is_left_alone,
        a_row_whose_file_is_gone_is_removed_with_what_is_beside_it,
        an_open_row_without_a_file_is_removed_alone_because_its_recorder_may_be_making_the_file,
        rows_of_recordings_whose_disk_is_away_are_added_when_it_is_back,
        rows_stay_where_no_file_is_there_because_a_disk_is_not_mounted,
        rows_stay_where_no_file_is_there_even_if_one_was_open_and_others_are_old,
        retention_leaves_the_row_of_a_file_that_is_not_there,
        nothing_is_deleted_where_the_folder_cannot_be_reached,
        files_of_others_are_never_touched_whatever_the_index_says,
        a_damaged_index_is_put_aside_and_recording_goes_on,
        every_damaged_index_is_put_aside_under_a_name_of_its_own_with_its_journal,
        a_deletion_that_fails_is_reported_once_and_the_row_stays,
        without_an_index_files_are_made_all_the_same_and_nothing_is_deleted,
        an_index_that_can_be_opened_later_gets_the_rows_of_what_was_recorded_meanwhile,
        a_recording_that_another_program_keeps_during_retention_is_not_deleted,
        files_that_cannot_be_deleted_leave_the_row_as_it_is,
        a_file_that_is_being_made_is_not_taken_for_what_a_killed_process_left,
        two_recorders_and_their_retention_in_one_folder_lose_nothing})
    tcase_add_test(cases, test);
  tcase_set_timeout(cases, 60);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
