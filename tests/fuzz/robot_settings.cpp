// SPDX-License-Identifier: LGPL-2.1-or-later
// A robot's configuration file.
#include <cstdint>

#include "robot/settings_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cerberus::robot::parse_settings({reinterpret_cast<const char*>(data), size}, "a file", "/");
  return 0;
}
