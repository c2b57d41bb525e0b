// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads one [[camera]] of the configuration file.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robot/table_reader.h"

namespace cerberus::robot {

// A file that the configuration names and that must be there.
struct NamedFile {
  std::uint32_t line = 0;
  std::string key, path;
  bool secret = false;
};

// Where files are that the configuration names by relative paths, and secrets that it names as credentials of systemd.
struct Folders {
  std::string_view configuration, credentials;
};

// `path`, below `folder` unless it is absolute; an empty folder changes nothing.
std::string below(std::string_view folder, std::string_view path);

// The path of the secret that "password-file" or "password-credential" of a table names, which belongs to the user of
// `user_key`; empty: there is none.
std::string read_password_path(TableReader& reader, const char* user_key, Folders folders,
                               std::vector<NamedFile>& files);

CameraSettings read_camera(const text::TomlValue& table, Folders folders, Mistakes& mistakes,
                           std::vector<NamedFile>& files);

}  // namespace cerberus::robot
