// SPDX-License-Identifier: LGPL-2.1-or-later
// The recordings of one folder for the page: their list, one of them, its deletion. The index is opened to read for each
// list; once it was changed it stays open, beside the recorder's own connection.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "record/archive/index.h"

namespace cerberus::robot {

class Events {
 public:
  // Recordings in a list at most: the newest.
  static constexpr std::size_t kMost = 200;

  // `folder` and `index` as of eventrecorder's `location` and `index`.
  explicit Events(std::string folder, std::string index = "recordings.sqlite")
      : folder_(std::move(folder)), index_(std::move(index)) {}

  // The newest first, as a JSON list; those of `camera` alone. `fault`: what is wrong; empty: nothing.
  std::string list(const std::string& camera, std::string& fault) const;
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

}  // namespace cerberus::robot
