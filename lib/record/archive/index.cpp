// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/index.h"

#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "record/archive/folder.h"

namespace cerberus::record {

namespace {

constexpr int kPatience = 2000;        // ms that another process's change is waited for
constexpr int kReadersPatience = 200;  // ms; a change does not hold readers up but for moments

// The step from version k to k + 1 of the tables. Steps are never changed, only added.
constexpr std::array kMigrations = {
    "CREATE TABLE recordings ("
    " id INTEGER PRIMARY KEY AUTOINCREMENT,"
    " file TEXT NOT NULL UNIQUE,"         // below the folder of the recordings
    " lines TEXT NOT NULL DEFAULT '',"    // JSON lines, ''
    " picture TEXT NOT NULL DEFAULT '',"  // JPEG, ''
    " camera TEXT NOT NULL DEFAULT '',"
    " event INTEGER NOT NULL DEFAULT 0,"
    " part INTEGER NOT NULL DEFAULT 1,"
    " begin INTEGER NOT NULL,"  // ns since 1970, UTC
    " end INTEGER NOT NULL,"
    " reason TEXT NOT NULL DEFAULT '',"
    " tracks TEXT NOT NULL DEFAULT '',"  // '4,7'
    " kinds TEXT NOT NULL DEFAULT '',"   // 'group,person-like'
    " rule TEXT NOT NULL DEFAULT '',"
    " size INTEGER NOT NULL DEFAULT 0,"  // bytes of file, lines and picture
    " open INTEGER NOT NULL DEFAULT 1,"
    " keep INTEGER NOT NULL DEFAULT 0);"
    "CREATE INDEX recordings_by_begin ON recordings (begin);",
    "ALTER TABLE recordings ADD COLUMN people INTEGER NOT NULL DEFAULT 0;"  // at once
    "ALTER TABLE recordings ADD COLUMN broken INTEGER NOT NULL DEFAULT 0;"  // 1: there is nothing to play in it
    "CREATE INDEX recordings_by_camera ON recordings (camera, begin);",
    // What read_newest() and read_reasons() ask for, in the order of ids: SQLite appends the id to every index.
    "CREATE INDEX recordings_by_camera_and_id ON recordings (camera) WHERE broken = 0;"
    "CREATE INDEX recordings_kept ON recordings (camera) WHERE keep <> 0;"
    "CREATE INDEX recordings_by_reason ON recordings (camera, CASE WHEN reason GLOB 'track [0-9]*'"
    " THEN rtrim(rtrim(reason, '0123456789'), ' ') ELSE reason END) WHERE broken = 0;",
};

// Other programs may write rows: a time that differences would overflow with becomes 1970 or a far future.
Time plausible(std::int64_t nanoseconds) {
  return Time(std::clamp(nanoseconds, std::int64_t{0}, Time::max().count() / 4));
}

// `path` as an address, of which SQLite reads ?, # and % otherwise.
std::string uri_of(const std::string& path) {
  std::string uri = path.starts_with('/') ? "file://" : "file:";
  for (const char letter : path) {
    if (letter == '?')
      uri += "%3f";
    else if (letter == '#')
      uri += "%23";
    else if (letter == '%')
      uri += "%25";
    else
      uri += letter;
  }
  return uri;
}

// "track 7": the numbers of tracks are many. As in recordings_by_reason, or that index does not serve.
constexpr char kReason[] =
    "CASE WHEN reason GLOB 'track [0-9]*' THEN rtrim(rtrim(reason, '0123456789'), ' ') ELSE reason END";
constexpr char kSelect[] = "SELECT ", kFrom[] = ", id, keep FROM recordings";
constexpr char kColumns[] =
    "file, lines, picture, camera, event, part, begin, end, reason, tracks, kinds, rule, size, open, people, "
    "broken";
constexpr char kPlaces[] = "(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)";

}  // namespace

// A prepared statement whose parameters are bound in order. Texts are bound without a copy: they outlive it.
class Index::Statement {
 public:
  Statement(sqlite3* database, const std::string& sql) {
    sqlite3_prepare_v2(database, sql.c_str(), -1, &statement_, nullptr);
  }
  ~Statement() { sqlite3_finalize(statement_); }
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  Statement& bind(std::string_view text) {
    sqlite3_bind_text(statement_, ++bound_, text.data(), static_cast<int>(text.size()), SQLITE_STATIC);
    return *this;
  }
  Statement& bind(std::int64_t number) {
    sqlite3_bind_int64(statement_, ++bound_, number);
    return *this;
  }
  // SQLITE_ROW, SQLITE_DONE, or an error; SQLITE_MISUSE where the statement could not be prepared.
  int step() { return statement_ ? sqlite3_step(statement_) : SQLITE_MISUSE; }
  std::int64_t number(int column) { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return bytes ? std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
                 : std::string();
  }
  Statement& bind(const Recording& row) {
    bind(row.file).bind(row.lines).bind(row.picture).bind(row.camera);
    bind(std::int64_t{row.event}).bind(std::int64_t{row.part}).bind(row.begin.count()).bind(row.end.count());
    bind(row.reason).bind(row.tracks).bind(row.kinds).bind(row.rule);
    bind(static_cast<std::int64_t>(row.bytes)).bind(std::int64_t{row.open});
    return bind(std::int64_t{row.people}).bind(std::int64_t{row.broken});
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int bound_ = 0;
};

void Index::Closer::operator()(sqlite3* database) const {
  sqlite3_close_v2(database);
}

Index::Index() = default;
Index::~Index() = default;

bool Index::available() {
  return true;
}

std::string Index::fault() const {
  return std::string("the index of recordings: ") + sqlite3_errmsg(database_.get());
}

std::string Index::run(const char* sql) {
  return sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) == SQLITE_OK ? std::string() : fault();
}

std::string Index::open(const std::string& path, bool& damaged) {
  close();
  damaged = false;
  const auto refuse = [&](int error) {
    close();
    return "the index of recordings " + in_quotes(path) + ": " + std::strerror(error);
  };
  // The file is never opened here: to close it would end the locks that other connections of this process have on it
  // (fcntl(2)), and another program would then take their journal for its own and delete it.
  struct stat about{};
  const bool is_new = stat(path.c_str(), &about) != 0;
  if (is_new && errno != ENOENT) return refuse(errno);
  if (!is_new && !S_ISREG(about.st_mode)) return refuse(S_ISDIR(about.st_mode) ? EISDIR : EINVAL);
  if (!is_new && access(path.c_str(), R_OK | W_OK) != 0) return refuse(errno);
  sqlite3* database = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_FULLMUTEX;
  const int result = sqlite3_open_v2(path.c_str(), &database, flags, nullptr);
  database_.reset(database);
  if (!database) return refuse(ENOMEM);
  if (result != SQLITE_OK)
    return refuse(sqlite3_system_errno(database) ? sqlite3_system_errno(database) : EIO);
  // SQLite gives its journal files the same mode; they are not there yet.
  if (is_new && chmod(path.c_str(), 0640) != 0) return refuse(errno);
  if (stat(path.c_str(), &about) == 0) file_ = {about.st_dev, about.st_ino};
  sqlite3_busy_timeout(database, kPatience);
  sqlite3_extended_result_codes(database, 1);
  // FULL: what is acknowledged outlasts a power cut. A schema that calls functions of its own is not trusted.
  std::string text =
      run("PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL; PRAGMA trusted_schema = OFF;");
  if (text.empty()) {
    Statement check(database, "PRAGMA quick_check(1)");
    if (check.step() != SQLITE_ROW) {
      text = fault();  // it may be locked or the memory short, which is no damage
    } else if (check.text(0) != "ok") {
      text = "the index of recordings " + in_quotes(path) + " is damaged";
      damaged = true;
    }
  }
  int code = sqlite3_errcode(database) & 0xff;
  if (text.empty()) {
    text = migrate();
    code = sqlite3_errcode(database) & 0xff;
  }
  damaged |= !text.empty() && (code == SQLITE_NOTADB || code == SQLITE_CORRUPT);
  // Its journal is put aside with it.
  if (damaged) sqlite3_db_config(database, SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, 1, nullptr);
  if (!text.empty()) close();
  return text;
}

std::string Index::open_to_read(const std::string& path) {
  std::string text;
  // A database in WAL mode makes files beside it even to be read; on a read-only disk it is one that never changes.
  for (const char* how : {"?mode=ro", "?mode=ro&immutable=1"}) {
    close();
    sqlite3* database = nullptr;
    const int result =
        sqlite3_open_v2((uri_of(path) + how).c_str(), &database,
                        SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_FULLMUTEX, nullptr);
    database_.reset(database);
    if (database == nullptr) return "out of memory";
    sqlite3_busy_timeout(database, kReadersPatience);
    if (result == SQLITE_OK) {
      run("PRAGMA trusted_schema = OFF;");
      Statement version(database, "PRAGMA user_version");
      if (version.step() == SQLITE_ROW) {
        if (version.number(0) == static_cast<std::int64_t>(kMigrations.size())) return {};
        text = "the index of recordings has version " + std::to_string(version.number(0)) +
               ", which this program does not know";
        break;
      }
    }
    text = fault();
    const int code = sqlite3_errcode(database) & 0xff;
    if (code != SQLITE_CANTOPEN && code != SQLITE_READONLY) break;
  }
  close();
  return text;
}

void Index::close() {
  database_.reset();
}

bool Index::is_at(const std::string& path) const {
  struct stat about{};
  return stat(path.c_str(), &about) == 0 &&
         file_ == std::pair<std::uint64_t, std::uint64_t>(about.st_dev, about.st_ino);
}

std::string Index::try_to_write() {
  sqlite3_busy_timeout(database_.get(), 0);
  std::string text = run("BEGIN IMMEDIATE");
  if (text.empty()) text = run("ROLLBACK");
  sqlite3_busy_timeout(database_.get(), kPatience);
  return text;
}

// In one transaction, so that two recorders that start together do it once.
std::string Index::migrate() {
  if (std::string text = run("BEGIN IMMEDIATE"); !text.empty()) return text;
  std::string text;
  std::int64_t version = 0;
  {
    Statement read(database_.get(), "PRAGMA user_version");
    if (read.step() == SQLITE_ROW) version = read.number(0);
  }
  if (version < 0 || version > static_cast<std::int64_t>(kMigrations.size()))
    text = "the index of recordings has version " + std::to_string(version) +
           ", which is newer than this program: update it, or name another index";
  for (auto k = static_cast<std::size_t>(version); text.empty() && k < kMigrations.size(); ++k) {
    text = run(kMigrations[k]);
    if (text.empty()) text = run(("PRAGMA user_version = " + std::to_string(k + 1)).c_str());
  }
  const std::string ended = run(text.empty() ? "COMMIT" : "ROLLBACK");
  return text.empty() ? ended : text;
}

std::string Index::add(Recording& recording, bool& taken) {
  taken = false;
  Statement insert(database_.get(),
                   std::string("INSERT INTO recordings (") + kColumns + ") VALUES " + kPlaces);
  const int result = insert.bind(recording).step();
  taken = result == SQLITE_CONSTRAINT_UNIQUE;
  if (result != SQLITE_DONE) return fault();
  recording.id = sqlite3_last_insert_rowid(database_.get());
  return {};
}

std::string Index::update(Recording& recording) {
  Statement change(database_.get(), std::string("UPDATE recordings SET (") + kColumns + ") = " + kPlaces +
                                        " WHERE id = ? AND file = ?");
  if (change.bind(recording).bind(recording.id).bind(recording.file).step() != SQLITE_DONE) return fault();
  if (sqlite3_changes(database_.get()) > 0) return {};
  bool taken = false;
  return add(recording, taken);
}

std::string Index::remove(const Recording& recording) {
  Statement statement(database_.get(), "DELETE FROM recordings WHERE id = ? AND file = ?");
  return statement.bind(recording.id).bind(recording.file).step() == SQLITE_DONE ? std::string() : fault();
}

std::string Index::remove_with(std::int64_t id, const std::function<bool()>& remove_files, bool& removed) {
  removed = false;
  if (std::string text = run("BEGIN IMMEDIATE"); !text.empty()) return text;
  std::string text;
  {
    Statement statement(database_.get(), "DELETE FROM recordings WHERE id = ? AND keep = 0 AND open = 0");
    if (statement.bind(id).step() != SQLITE_DONE) text = fault();
  }
  removed = text.empty() && sqlite3_changes(database_.get()) > 0 && remove_files();
  const std::string ended = run(removed ? "COMMIT" : "ROLLBACK");
  if (!ended.empty()) {
    removed = false;
    if (!sqlite3_get_autocommit(database_.get())) run("ROLLBACK");
  }
  return text.empty() ? ended : text;
}

std::string Index::set_keep(std::string_view file, bool keep) {
  Statement statement(database_.get(), "UPDATE recordings SET keep = ? WHERE file = ?");
  if (statement.bind(std::int64_t{keep}).bind(file).step() != SQLITE_DONE) return fault();
  if (sqlite3_changes(database_.get()) == 0) return "the index of recordings has no file " + in_quotes(file);
  return {};
}

std::string Index::read(std::vector<Recording>& rows) {
  Statement select(database_.get(), std::string(kSelect) + kColumns + kFrom + " ORDER BY id");
  return collect(select, rows);
}

std::string Index::read_newest(const Wanted& wanted, std::vector<Recording>& rows) {
  std::string where = " WHERE camera = ? AND broken = 0";
  if (wanted.from) where += " AND begin >= ?";
  if (wanted.until) where += " AND begin < ?";
  if (!wanted.reason.empty()) where += std::string(" AND ") + kReason + " = ?";
  if (wanted.kept) where += " AND keep <> 0";
  // A day has few rows, which are sorted; from `below` down there may be as many as there are.
  if (wanted.below) where += wanted.from ? " AND +id < ?" : " AND id < ?";
  Statement select(database_.get(),
                   std::string(kSelect) + kColumns + kFrom + where + " ORDER BY id DESC LIMIT ?");
  select.bind(wanted.camera);
  if (wanted.from) select.bind(wanted.from->count());
  if (wanted.until) select.bind(wanted.until->count());
  if (!wanted.reason.empty()) select.bind(wanted.reason);
  if (wanted.below) select.bind(*wanted.below);
  select.bind(static_cast<std::int64_t>(wanted.most));
  return collect(select, rows);
}

std::string Index::read_reasons(std::string_view camera, std::vector<std::string>& reasons) {
  reasons.clear();
  Statement select(
      database_.get(),
      std::string(kSelect) + "DISTINCT " + kReason +
          " AS what FROM recordings WHERE camera = ? AND broken = 0 AND what <> '' ORDER BY what");
  select.bind(camera);
  int result = SQLITE_DONE;
  while ((result = select.step()) == SQLITE_ROW) reasons.push_back(select.text(0));
  return result == SQLITE_DONE ? std::string() : fault();
}

std::string Index::read_one(std::int64_t id, std::vector<Recording>& rows) {
  Statement select(database_.get(), std::string(kSelect) + kColumns + kFrom + " WHERE id = ?");
  select.bind(id);
  return collect(select, rows);
}

std::string Index::collect(Statement& select, std::vector<Recording>& rows) const {
  rows.clear();
  int result = SQLITE_DONE;
  while ((result = select.step()) == SQLITE_ROW) {
    Recording& row = rows.emplace_back();
    row.file = select.text(0), row.lines = select.text(1), row.picture = select.text(2),
    row.camera = select.text(3);
    row.event = static_cast<std::uint32_t>(select.number(4));
    row.part = static_cast<std::uint32_t>(select.number(5));
    row.begin = plausible(select.number(6)), row.end = plausible(select.number(7));
    row.reason = select.text(8), row.tracks = select.text(9), row.kinds = select.text(10),
    row.rule = select.text(11);
    row.bytes = static_cast<std::uint64_t>(std::max<std::int64_t>(0, select.number(12)));
    row.open = select.number(13) != 0;
    row.people = static_cast<std::uint32_t>(select.number(14));
    row.broken = select.number(15) != 0;
    row.id = select.number(16);
    row.keep = select.number(17) != 0;
  }
  return result == SQLITE_DONE ? std::string() : fault();
}

}  // namespace cerberus::record
