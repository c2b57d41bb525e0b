// SPDX-License-Identifier: LGPL-2.1-or-later
// The recordings of one folder for the page: their list, one of them, its deletion. Opens the index for each call, as the
// recorder has it open, too; to list and find for reading alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

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
  // Deletes file, lines, picture and row; returns what is wrong. What is being written is refused.
  std::string remove(const std::string& camera, std::int64_t id) const;

  // Whether retention leaves it; returns what is wrong.
  std::string keep(const std::string& camera, std::int64_t id, bool keep) const;

 private:
  std::string read(std::vector<record::Recording>& rows, record::Index& index) const;
  bool open_to_read(record::Index& index, std::string& fault) const;

  std::string folder_, index_;
};

}  // namespace cerberus::robot
