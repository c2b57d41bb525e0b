// SPDX-License-Identifier: LGPL-2.1-or-later
// The recordings of one folder for the page: their list, one of them, its deletion. Opens the index for each call, as the
// recorder has it open, too.
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

  // The newest first, as a JSON list; those of `camera` alone.
  std::string list(const std::string& camera) const;
  std::optional<record::Recording> find(const std::string& camera, std::int64_t id) const;
  // Deletes file, lines, picture and row; returns what is wrong. What is being written is refused.
  std::string remove(const std::string& camera, std::int64_t id) const;

  // Whether retention leaves it; returns what is wrong.
  std::string keep(const std::string& camera, std::int64_t id, bool keep) const;

  const std::string& folder() const { return folder_; }

 private:
  std::string read(std::vector<record::Recording>& rows, record::Index& index) const;

  std::string folder_, index_;
};

}  // namespace cerberus::robot
