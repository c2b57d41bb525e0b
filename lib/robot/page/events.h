// SPDX-License-Identifier: LGPL-2.1-or-later
// The recordings of one folder for the page: their list, one of them, its deletion. The index is opened to read for each
// list; once it was changed it stays open, beside the recorder's own connection.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "record/archive/index.h"

namespace cerberus::robot {

class Events {
 public:
  // Recordings in a list at most.
  static constexpr std::size_t kMost = 200;

  // `folder` and `index` as of eventrecorder's `location` and `index`.
  explicit Events(std::string folder, std::string index = "recordings.sqlite")
      : folder_(std::move(folder)), index_(std::move(index)) {}

  // Those that are wanted, kMost at most, the newest first, as a JSON list. `fault`: what is wrong; empty: nothing.
  std::string list(record::Wanted wanted, std::string& fault) const;
  // What began recordings of a camera, as a JSON list of texts.
  std::string reasons(const std::string& camera, std::string& fault) const;
  std::optional<record::Recording> find(const std::string& camera, std::int64_t id, std::string& fault) const;
  // The newest recording of a camera, a JSON object as in the list; empty: there is none.
  std::string newest(const std::string& camera, std::string& fault) const;
  // Deletes file, lines, picture and row; returns what is wrong. What is being written is refused.
  std::string remove(const std::string& camera, std::int64_t id);

  // Whether retention leaves it; returns what is wrong.
  std::string keep(const std::string& camera, std::int64_t id, bool keep);

 private:
  std::string open_to_change();
  std::string find_to_change(const std::string& camera, std::int64_t id, record::Recording& row);
  bool open_to_read(record::Index& index, std::string& fault) const;

  std::string folder_, index_;
  record::Index changes_;                           // open since the first change
  std::pair<std::uint64_t, std::uint64_t> file_{};  // device and inode of it
};

// The name under which a file of a recording is saved: camera and local time, "front_2026-11-28_14-30-05.mp4".
std::string download_name(const record::Recording& row, std::string_view file);

}  // namespace cerberus::robot
