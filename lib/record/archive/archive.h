// SPDX-License-Identifier: LGPL-2.1-or-later
// The recordings of one folder: their names, their rows in the index, their deletion. A recording is a video file and,
// beside it under the same name, JSON lines (.jsonl) and a picture (.jpg); all three and the row live and die together.
//
// Order: row, file, ..., file complete and on the disk, row closed. What a killed process leaves open is put right at the
// next start. Recordings go on where the index fails; such faults are complaints. Not thread-safe.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "record/archive/folder.h"
#include "record/archive/index.h"
#include "record/archive/retention.h"

namespace cerberus::record {

class Archive {
 public:
  struct Settings {
    std::string folder;
    std::string index;  // a path; relative: below the folder; empty: no index, and so no retention
    Limits limits;
  };

  // Opens the index and reconciles rows and files:
  // - a row without its file is removed with what else is left of it, or alone where it is open;
  // - a row that a process left open is closed with what is there: MP4 is repaired, a file in which nothing plays is
  //   marked as broken;
  // - a row of a file without content is removed with it.
  // A damaged index is renamed to NAME.damaged and begun anew. Then retention is applied: returns the files that were
  // deleted. An index that cannot be opened is tried again by retain(), every 10 s; what is recorded until then gets its
  // rows then, while the process runs and the file is there.
  std::vector<std::string> open(const Settings& settings, const Surroundings& now);
  void set_limits(const Limits& limits) { settings_.limits = limits; }
  void close();

  // Makes the file of a recording: `name` and `ending`, or where that is taken `name`~1, `name`~2 ... Fills in
  // `recording`'s file and id. Returns what is wrong; an empty string: nothing.
  std::string begin(Recording& recording, const std::string& name, std::string_view ending, OpenFile& file);
  // Makes a file beside it, and notes its name in `recording`. Returns an errno.
  int add_lines(Recording& recording, OpenFile& file) const;
  int add_picture(Recording& recording, OpenFile& file) const;
  // Of a recording whose writer failed: repairs it, or notes that it is broken.
  void examine(Recording& recording, const OpenFile& file);
  // Closes the row of a recording whose files are complete. `file` is written to the disk before.
  void finish(Recording& recording, const OpenFile& file);
  // Deletes the files and the row.
  void discard(const Recording& recording);

  // Applies retention, unless the folder cannot be reached. Returns the files that were deleted.
  std::vector<std::string> retain(const Surroundings& now);
  // Sets or clears `keep` of a file, by its name or its path. Returns what is wrong.
  std::string keep(const std::string& file, bool keep);

  // Looks whether the index is the one of the folder still and can be written; meant for every few seconds.
  void watch(Time steady);
  // Why new recordings are not listed; empty: they are, or there is to be no index.
  const std::string& index_fault() const { return index_fault_; }
  // Whether the file of a recording is still where it was made.
  bool is_there(const Recording& recording, const OpenFile& file) const {
    return folder_.is_there(recording.file, file);
  }

  // The faults of the index and of deletions since the last call, each once until it changes.
  std::vector<std::string> take_complaints();

 private:
  // How often an index that could not be opened is tried again. Chosen: a mount that comes late or a lock that ends is
  // noticed soon. Guarded by the test of an index that can be opened later.
  static constexpr Time kPause = std::chrono::seconds(10);
  // Recordings that wait for their rows. Derived: a day of an event a minute; 300 bytes each.
  static constexpr std::size_t kMostUnlisted = 1440;

  void complain(std::string text);
  bool note(const std::string& fault);
  void check_place(Time steady);
  std::string index_path() const;
  void open_index(Time steady);
  std::vector<std::string> apply_retention(Surroundings now);
  void list();
  void reconcile();
  void reconcile(Recording& row);
  bool restore(Recording& row, const OpenFile& file);
  bool remove_files(const Recording& recording);
  void measure(Recording& recording) const;

  Settings settings_;
  Folder folder_{"."};
  Index index_;
  Retention retention_;
  Time open_again_{};                // steady: when the index is tried again
  std::vector<Recording> unlisted_;  // complete, and without a row
  bool overflow_reported_ = false;   // of unlisted_
  std::vector<std::string> complaints_;
  std::string last_complaint_, index_fault_;
};

}  // namespace cerberus::record
