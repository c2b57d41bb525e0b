// SPDX-License-Identifier: LGPL-2.1-or-later
// A user's file of rules.
#include <cstdint>

#include "fusion/rule_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cerberus::fusion::parse_rules({reinterpret_cast<const char*>(data), size}, "a file");
  return 0;
}
