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

// `path`, below `folder` unless it is absolute; an empty folder changes nothing.
std::string below(std::string_view folder, std::string_view path);

CameraSettings read_camera(const text::TomlValue& table, std::string_view folder, Mistakes& mistakes,
                           std::vector<NamedFile>& files);

}  // namespace cerberus::robot
