// SPDX-License-Identifier: LGPL-2.1-or-later
// A message of an open page.
#include <cstdint>

#include "robot/page/page_commands.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cerberus::robot::parse_command({reinterpret_cast<const char*>(data), size});
  return 0;
}
