// SPDX-License-Identifier: LGPL-2.1-or-later
// The index of recordings: an SQLite database with a row a file, which other programs may read while it is written (WAL)
// and whose column `keep` they may set. Every method that can fail returns what is wrong in words for a user; an empty
// string: nothing. Not thread-safe; several processes may have the same database open.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "record/unit.h"

struct sqlite3;

namespace cerberus::record {

// A row. Names of files are relative to the folder of the recordings; an empty one: there is none.
struct Recording {
  std::int64_t id = 0;  // rises with time
  std::string file, lines, picture;
  std::string camera;
  std::uint32_t event = 0, part = 1;
  Time begin{}, end{};        // UTC, since 1970
  std::string reason;         // the trigger
  std::string tracks, kinds;  // identities, kinds of object; parted by commas
  std::string rule;           // of the fusion
  std::uint64_t bytes = 0;    // of all its files
  std::uint32_t people = 0;   // at once, as far as was judged by their size
  bool open = true;           // is being written, or was when the process ended
  bool broken = false;        // its writer was cut off before there was anything to play
  bool keep = false;          // retention leaves it
};

// Which rows of a camera.
struct Wanted {
  std::string camera;
  std::optional<Time> from, until;    // of their begin: `from` counts, `until` does not
  std::string reason;                 // as of read_reasons(); empty: every one
  bool kept = false;                  // only recordings whose `keep` is set
  std::optional<std::int64_t> below;  // ids below this one: what follows a list whose last id it is
  std::size_t most = 200;
};

class Index {
 public:
  // Whether this build has SQLite; without it open() always fails.
  static bool available();

  Index();
  ~Index();

  // Opens the database or makes it (mode 0640), and brings older versions of its tables up to the present one. Fails
  // for a file that is no database or is damaged (`damaged` becomes true), and for one of a newer version.
  std::string open(const std::string& path, bool& damaged);
  // Opens a database that is there to read alone, at once: nothing is checked, brought up to date or written, and its
  // disk may be read-only.
  std::string open_to_read(const std::string& path);
  void close();
  bool is_open() const { return database_ != nullptr; }
  // Whether the database at this path is the one that open() opened: its folder may have been made anew.
  bool is_at(const std::string& path) const;
  // Whether rows could be written now: returns what is wrong, and waits for no other program.
  std::string try_to_write();

  // Adds a row, and sets its id. `taken` becomes true if there is a row with that file.
  std::string add(Recording& recording, bool& taken);
  // Overwrites all of a row but `keep`; adds it anew if it is gone. A row is that of its id and its file: the index may
  // have been begun anew since the id was given.
  std::string update(Recording& recording);
  std::string remove(const Recording& recording);
  // Removes a row that is neither open nor to be kept, and keeps every other program from changing it meanwhile:
  // remove_files() is called in between, and where it returns false the row stays. `removed`: the row is gone now, and
  // was there.
  std::string remove_with(std::int64_t id, const std::function<bool()>& remove_files, bool& removed);
  std::string set_keep(std::string_view file, bool keep);
  // Reads the rows by rising id.
  std::string read(std::vector<Recording>& rows);
  // The newest rows of these, the newest first; never broken ones.
  std::string read_newest(const Wanted& wanted, std::vector<Recording>& rows);
  // What began the recordings of a camera, without the numbers of tracks, each once, in the order of letters.
  std::string read_reasons(std::string_view camera, std::vector<std::string>& reasons);
  // The row of an id: one, or none.
  std::string read_one(std::int64_t id, std::vector<Recording>& rows);

 private:
  class Statement;
  std::string run(const char* sql);
  std::string collect(Statement& select, std::vector<Recording>& rows) const;
  std::string migrate();
  std::string fault() const;

  struct Closer {
    void operator()(sqlite3* database) const;
  };
  std::unique_ptr<sqlite3, Closer> database_;
  std::pair<std::uint64_t, std::uint64_t> file_{};  // device and inode of what open() opened
};

}  // namespace cerberus::record
