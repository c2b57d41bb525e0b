// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads one [[camera]] of the configuration file.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "robot/tables/table_reader.h"

namespace cerberus::robot {

// A file that the configuration names and that must be there.
struct NamedFile {
  std::uint32_t line = 0;
  std::string key, path;
  bool secret = false;
  bool users = false;   // it lists users, in the lines of publish::parse_users
  std::string owner{};  // "page", "camera NAME", ...
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

// The path of a credential of systemd; what is no name of one is a mistake.
std::string credential_path(TableReader& reader, const char* key, const std::string& name, Folders folders,
                            std::vector<NamedFile>& files);

// "encoder" and "bitrate" of a table, of encoders whose codec is one of `codecs`.
void read_encoder(TableReader& reader, std::initializer_list<std::string_view> codecs,
                  EncoderSettings& encoder);

CameraSettings read_camera(const text::TomlValue& table, Folders folders, Mistakes& mistakes,
                           std::vector<NamedFile>& files);

}  // namespace cerberus::robot
