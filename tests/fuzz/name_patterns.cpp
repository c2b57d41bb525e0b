// SPDX-License-Identifier: LGPL-2.1-or-later
// The pattern of the recordings' names, which a user writes, and the camera's name, which may come from a network: the
// first line is the one, the rest the other. Whatever they are, the name stays below the folder.
#include <cstdlib>

#include "record/archive/folder.h"
#include "record/file_names.h"

using namespace cerberus::record;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = text.find('\n');
  const std::string_view pattern = text.substr(0, line);
  const std::string_view camera = line == std::string_view::npos ? std::string_view() : text.substr(line + 1);
  if (!name_pattern_fault(pattern).empty()) return 0;
  const std::string name = expand_name(pattern, {std::chrono::seconds(1'795'389'333), camera, 7, 2});
  if (!Folder::is_name(name + ".mp4")) std::abort();
  return 0;
}
