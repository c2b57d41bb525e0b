// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/index.h"

#include <check.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>

#include "support/suite.h"
#include "support/temporary_folder.h"

using namespace cerberus;
using namespace cerberus::record;

namespace {

Recording row(const std::string& file) {
  Recording made;
  made.file = file;
  made.camera = "yard's";
  made.event = 3;
  made.part = 2;
  made.begin = Time(1'795'389'333'736'236'000);
  made.end = made.begin + std::chrono::seconds(9);
  made.reason = "track 7";
  return made;
}

std::vector<Recording> rows_of(Index& index) {
  std::vector<Recording> rows;
  ck_assert((index.read(rows)).empty());
  return rows;
}

void open(Index& index, const std::string& path) {
  bool damaged = true;
  ck_assert((index.open(path, damaged)).empty());
  ck_assert(!damaged);
}

// What the program of SQLite itself reads from the database.
std::string ask(const std::string& path, const char* sql) {
  sqlite3* database = nullptr;
  ck_assert_int_eq(sqlite3_open(path.c_str(), &database), SQLITE_OK);
  std::string text;
  sqlite3_exec(
      database, sql,
      [](void* to, int columns, char** values, char**) {
        for (int k = 0; k < columns; ++k)
          *static_cast<std::string*>(to) += std::string(values[k] ? values[k] : "-") + '|';
        return 0;
      },
      &text, nullptr);
  sqlite3_close(database);
  return text;
}

}  // namespace

START_TEST(a_row_is_read_as_it_was_written) {
  const TemporaryFolder folder;
  Index index;
  open(index, folder.path + "/i.sqlite");
  Recording written = row("a/b.mp4");
  bool taken = true;
  ck_assert((index.add(written, taken)).empty());
  ck_assert(!taken);
  written.lines = "a/b.jsonl", written.picture = "a/b.jpg", written.tracks = "4,7", written.kinds = "group";
  written.rule = "sector", written.bytes = 1ULL << 40, written.open = false;
  ck_assert((index.update(written)).empty());
  const auto rows = rows_of(index);
  ck_assert_uint_eq(rows.size(), 1);
  const Recording& read = rows[0];
  ck_assert_int_eq(read.id, written.id);
  ck_assert_str_eq(read.file.c_str(), "a/b.mp4");
  ck_assert_str_eq(read.lines.c_str(), "a/b.jsonl");
  ck_assert_str_eq(read.picture.c_str(), "a/b.jpg");
  ck_assert_str_eq(read.camera.c_str(), "yard's");
  ck_assert(read.event == 3 && read.part == 2 && read.begin == written.begin && read.end == written.end);
  ck_assert_str_eq(read.reason.c_str(), "track 7");
  ck_assert_str_eq(read.tracks.c_str(), "4,7");
  ck_assert_str_eq(read.kinds.c_str(), "group");
  ck_assert_str_eq(read.rule.c_str(), "sector");
  ck_assert(read.bytes == 1ULL << 40 && !read.open && !read.keep);
}
END_TEST

START_TEST(a_reader_sees_the_newest_rows_of_a_camera_and_changes_nothing) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/a ?#%41.sqlite";
  Index reader;
  ck_assert(!reader.open_to_read(path).empty() && !reader.is_open() && !std::filesystem::exists(path));
  {
    Index index;
    open(index, path);
    bool taken = false;
    for (const char* file : {"1", "2", "3", "other", "4"}) {
      Recording made = row(file);
      if (made.file == "other") made.camera = "gate";
      ck_assert(index.add(made, taken).empty());
    }
    // While another one writes.
    ck_assert(reader.open_to_read(path).empty());
    std::vector<Recording> rows;
    ck_assert(
        reader
            .read_newest({.camera = "yard's", .from = {}, .until = {}, .reason = {}, .below = {}, .most = 3},
                         rows)
            .empty());
    ck_assert_uint_eq(rows.size(), 3);
    ck_assert(rows[0].file == "4" && rows[1].file == "3" && rows[2].file == "2");
    ck_assert(reader.read_one(4, rows).empty() && rows.size() == 1 && rows[0].file == "other");
    ck_assert(reader.read_one(6, rows).empty() && rows.empty());
    ck_assert(!reader.remove(Recording{}).empty());
    reader.close();
  }
  // A read-only disk, on which SQLite can make no file beside the database.
  std::filesystem::permissions(folder.path, std::filesystem::perms(0555));
  ck_assert(reader.open_to_read(path).empty());
  std::vector<Recording> rows;
  ck_assert(reader.read_newest({.camera = "gate", .from = {}, .until = {}, .reason = {}, .below = {}}, rows)
                .empty() &&
            rows.size() == 1);
  reader.close();
  std::filesystem::permissions(folder.path, std::filesystem::perms(0755));
}
END_TEST

// 500 of three days, of which the oldest ones are asked for.
START_TEST(the_index_answers_day_reason_and_kept_and_goes_on_below_an_id) {
  const TemporaryFolder folder;
  Index index;
  open(index, folder.path + "/i.sqlite");
  constexpr Time kDay = std::chrono::hours(24), kFirst = 20'000 * kDay;
  for (int k = 0; k < 500; ++k) {
    Recording made = row(std::to_string(k));
    made.camera = "yard";
    made.begin = kFirst + (k < 5 ? Time::zero() : k < 250 ? kDay : 2 * kDay) + std::chrono::seconds(k);
    made.reason = k % 2 ? "track " + std::to_string(k) : k == 300 ? "gate 2" : "pir";
    made.broken = k == 4;
    bool taken = false;
    ck_assert(index.add(made, taken).empty());
    if (k == 1 || k == 300) ck_assert(index.set_keep(made.file, true).empty());
  }
  std::vector<Recording> rows;
  const auto files = [&](const Wanted& wanted) {
    ck_assert(index.read_newest(wanted, rows).empty());
    std::string all;
    for (const Recording& each : rows) all += each.file + ' ';
    return all;
  };
  Wanted wanted;
  wanted.camera = "yard";
  wanted.from = kFirst;
  wanted.until = kFirst + kDay;
  ck_assert(files(wanted) == "3 2 1 0 ");  // 4 is broken
  wanted.reason = "track";
  ck_assert(files(wanted) == "3 1 ");
  wanted.kept = true;
  ck_assert(files(wanted) == "1 ");
  wanted.from = wanted.until = {};
  wanted.reason = {};
  ck_assert(files(wanted) == "300 1 ");
  wanted.kept = false;
  std::size_t count = 0;
  for (std::string last = "500"; files(wanted) != ""; last = rows.back().file) {
    ck_assert_int_eq(std::stoi(rows.front().file), std::stoi(last) - 1 - (last == "5" ? 1 : 0));
    count += rows.size();
    wanted.below = rows.back().id;
  }
  ck_assert_uint_eq(count, 499);
  std::vector<std::string> reasons;
  ck_assert(index.read_reasons("yard", reasons).empty());
  ck_assert(reasons == (std::vector<std::string>{"gate 2", "pir", "track"}));
}
END_TEST

// What the statements of a connection cost, as SQLite counts it: the steps of its machine, and sorts.
struct Cost {
  int steps = 0, sorts = 0;
} cost;

int count_costs(sqlite3* database, char**, const sqlite3_api_routines*) {
  const auto add = [](unsigned, void*, void* statement, void*) {
    auto* ended = static_cast<sqlite3_stmt*>(statement);
    cost.steps += sqlite3_stmt_status(ended, SQLITE_STMTSTATUS_VM_STEP, 1);
    cost.sorts += sqlite3_stmt_status(ended, SQLITE_STMTSTATUS_SORT, 1);
    return 0;
  };
  return sqlite3_trace_v2(database, SQLITE_TRACE_PROFILE, add, nullptr);
}

START_TEST(a_page_of_a_hundred_thousand_rows_costs_what_a_page_of_few_does) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/index";
  {
    Index index;
    open(index, path);
  }
  // Two cameras, a recording a minute, every seventh by hand, every five thousandth kept; many rows in one statement.
  ask(path,
      "WITH RECURSIVE n(k) AS (SELECT 0 UNION ALL SELECT k + 1 FROM n WHERE k < 99999) "
      "INSERT INTO recordings (file, camera, begin, end, reason, keep, open) "
      "SELECT k || '.mp4', iif(k % 2, 'front', 'back'), k * 60000000000, k * 60000000000 + 1,"
      " iif(k % 7, 'track ' || k, 'application'), k % 5000 = 1, 0 FROM n");
  sqlite3_auto_extension(reinterpret_cast<void (*)()>(count_costs));
  Index index;
  ck_assert(index.open_to_read(path).empty());
  const auto day = [](int which) { return Time(std::chrono::hours(24 * which)); };
  std::vector<Wanted> kinds(8);
  for (Wanted& wanted : kinds) wanted.camera = "front";
  kinds[1].below = 50000;
  for (const std::size_t of_a_day : {2, 3}) {
    kinds[of_a_day].from = day(30);
    kinds[of_a_day].until = day(31);
  }
  kinds[3].below = 43300;
  kinds[4].kept = true;
  kinds[5].reason = kinds[6].reason = "application";
  kinds[6].below = 50000;
  kinds[7].reason = "nothing";
  for (const Wanted& wanted : kinds) {
    cost = {};
    std::vector<Recording> rows;
    ck_assert(index.read_newest(wanted, rows).empty());
    // 200 rows of 18 columns, or the 720 of a day with a sort of these.
    const bool of_a_day = wanted.from.has_value();
    ck_assert_msg(cost.steps < (of_a_day ? 60000 : 15000), "%ld: %d steps", &wanted - kinds.data(),
                  cost.steps);
    ck_assert_msg(cost.sorts == (of_a_day ? 1 : 0), "%ld: %d sorts", &wanted - kinds.data(), cost.sorts);
  }
  cost = {};
  std::vector<std::string> reasons;
  ck_assert(index.read_reasons("front", reasons).empty());
  ck_assert(reasons == (std::vector<std::string>{"application", "track"}));
  ck_assert_int_eq(cost.sorts, 0);
  index.close();
  sqlite3_reset_auto_extension();
}
END_TEST

START_TEST(the_database_is_one_that_others_read_by_its_documented_columns) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/i.sqlite";
  Index index;
  open(index, path);
  Recording written = row("b.mp4");
  bool taken = false;
  index.add(written, taken);
  const std::string read =
      ask(path, "SELECT camera, begin, end, tracks, kinds, rule, picture, size, keep, open FROM recordings");
  ck_assert_str_eq(read.c_str(), "yard's|1795389333736236000|1795389342736236000|||||0|0|1|");
  const std::string modes = ask(path, "PRAGMA journal_mode; PRAGMA user_version");
  ck_assert_str_eq(modes.c_str(), "wal|3|");
  struct stat about{};
  ck_assert_int_eq(stat(path.c_str(), &about), 0);
  ck_assert_int_eq(about.st_mode & 0777 & ~0640, 0);
}
END_TEST

START_TEST(a_file_has_one_row) {
  const TemporaryFolder folder;
  Index index;
  open(index, folder.path + "/i.sqlite");
  Recording a = row("a.mp4"), b = row("a.mp4");
  bool taken = false;
  index.add(a, taken);
  ck_assert(!(index.add(b, taken)).empty());
  ck_assert(taken);
  ck_assert_uint_eq(rows_of(index).size(), 1);
}
END_TEST

START_TEST(keep_is_what_was_set_last_and_updates_leave_it) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/i.sqlite";
  Index index;
  open(index, path);
  Recording a = row("a.mp4");
  bool taken = false;
  index.add(a, taken);
  ask(path, "UPDATE recordings SET keep = 1");  // another program
  a.open = false;
  ck_assert((index.update(a)).empty());
  ck_assert(rows_of(index)[0].keep);
  ck_assert((index.set_keep("a.mp4", false)).empty());
  ck_assert(!rows_of(index)[0].keep);
  ck_assert(index.set_keep("b.mp4", true).find("b.mp4") != std::string::npos);
}
END_TEST

START_TEST(a_row_that_was_removed_meanwhile_is_written_anew) {
  const TemporaryFolder folder;
  Index index;
  open(index, folder.path + "/i.sqlite");
  Recording a = row("a.mp4");
  bool taken = false;
  index.add(a, taken);
  ck_assert((index.remove(a)).empty());
  ck_assert(rows_of(index).empty());
  ck_assert((index.update(a)).empty());
  ck_assert(rows_of(index).at(0).file == "a.mp4");
}
END_TEST

START_TEST(two_recorders_write_into_one_index) {
  const TemporaryFolder folder;
  Index a, b;
  open(a, folder.path + "/i.sqlite");
  open(b, folder.path + "/i.sqlite");
  bool taken = false;
  for (int k = 0; k < 20; ++k) {
    Recording one = row(std::to_string(k) + "a.mp4"), two = row(std::to_string(k) + "b.mp4");
    ck_assert((a.add(one, taken)).empty());
    ck_assert((b.add(two, taken)).empty());
  }
  ck_assert_uint_eq(rows_of(a).size(), 40);
}
END_TEST

int change(const char* path) {
  sqlite3* database = nullptr;
  int result = sqlite3_open(path, &database);
  if (result == SQLITE_OK)
    result = sqlite3_exec(database, "UPDATE recordings SET keep = 0", nullptr, nullptr, nullptr);
  sqlite3_close(database);
  return result;
}

// This program again, which another process of the system is: it opens the database, changes a row and closes it.
void let_another_program_change(const std::string& path) {
  const std::string own = std::filesystem::read_symlink("/proc/self/exe");
  ck_assert_int_eq(std::system(('"' + own + "\" change \"" + path + '"').c_str()), 0);
}

// A process that opens a file and closes it loses all its locks on it; the program that comes then takes itself for the
// last one and deletes the journal.
START_TEST(what_is_recorded_after_another_program_had_the_index_is_in_it) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/i.sqlite";
  Index recorder, page, reader;
  open(recorder, path);
  Recording a = row("a.mp4"), b = row("b.mp4");
  bool taken = false;
  ck_assert(recorder.add(a, taken).empty());
  open(page, path);
  ck_assert(page.set_keep("a.mp4", true).empty());
  let_another_program_change(path);
  ck_assert(std::filesystem::exists(path + "-wal"));
  ck_assert(recorder.add(b, taken).empty());
  ck_assert(reader.open_to_read(path).empty());
  ck_assert_uint_eq(rows_of(reader).size(), 2);
  ck_assert(ask(path, "SELECT count(*) FROM recordings") == "2|");
}
END_TEST

START_TEST(an_index_of_a_newer_version_is_refused_and_stays_as_it_is) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/i.sqlite";
  ask(path, "CREATE TABLE recordings (wholly INTEGER, other TEXT); PRAGMA user_version = 99");
  Index index;
  bool damaged = true;
  const std::string fault = index.open(path, damaged);
  ck_assert(fault.find("99") != std::string::npos);
  ck_assert(!damaged && !index.is_open());
  ck_assert(ask(path, "PRAGMA user_version") == "99|");
}
END_TEST

START_TEST(a_file_that_is_no_database_is_damaged_and_one_that_cannot_be_made_is_not) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/i.sqlite";
  std::ofstream(path) << std::string(5000, 'x');
  Index index;
  bool damaged = false;
  ck_assert(!(index.open(path, damaged)).empty());
  ck_assert(damaged);
  const std::string fault = index.open(folder.path + "/nowhere/i.sqlite", damaged);
  ck_assert(fault.find("nowhere") != std::string::npos);
  ck_assert(!damaged);
}
END_TEST

START_TEST(any_bytes_are_refused_or_read_and_never_end_the_program) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/i.sqlite";
  {
    Index index;
    open(index, path);
    bool taken = false;
    for (int k = 0; k < 30; ++k) {
      Recording a = row(std::to_string(k) + ".mp4");
      index.add(a, taken);
    }
  }
  std::ifstream file(path, std::ios::binary);
  const std::string sound((std::istreambuf_iterator<char>(file)), {});
  std::mt19937 random(7);
  for (int round = 0; round < 60; ++round) {
    std::string bytes = sound;
    for (int k = 0; k < 1 + round; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    if (round % 5 == 0) bytes.resize(random() % bytes.size());
    std::ofstream(path, std::ios::binary) << bytes;
    for (const char* journal : {"-wal", "-shm"}) std::filesystem::remove(path + journal);
    Index index;
    bool damaged = false;
    std::vector<Recording> rows;
    if (index.open(path, damaged).empty()) index.read(rows);
    for (const Recording& each : rows) ck_assert(each.begin >= Time::zero() && each.end >= Time::zero());
  }
}
END_TEST

int main(int argc, char** argv) {
  if (argc == 3) return change(argv[2]);
  Suite* suite = suite_create("index");
  TCase* cases = tcase_create("index");
  tcase_set_timeout(cases, 60);  // rows are written through to the disk
  for (const TTest* test :
       {a_row_is_read_as_it_was_written, a_reader_sees_the_newest_rows_of_a_camera_and_changes_nothing,
        the_index_answers_day_reason_and_kept_and_goes_on_below_an_id,
        a_page_of_a_hundred_thousand_rows_costs_what_a_page_of_few_does,
        the_database_is_one_that_others_read_by_its_documented_columns, a_file_has_one_row,
        keep_is_what_was_set_last_and_updates_leave_it, a_row_that_was_removed_meanwhile_is_written_anew,
        two_recorders_write_into_one_index, what_is_recorded_after_another_program_had_the_index_is_in_it,
        an_index_of_a_newer_version_is_refused_and_stays_as_it_is,
        a_file_that_is_no_database_is_damaged_and_one_that_cannot_be_made_is_not,
        any_bytes_are_refused_or_read_and_never_end_the_program})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
