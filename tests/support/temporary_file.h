// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <string>

namespace cerberus::tests {

// The path of a new file with this text. The caller removes it.
inline std::string temporary_file(const std::string& text) {
  char path[] = "/tmp/cerberus-XXXXXX";
  const int fd = mkstemp(path);
  if (fd < 0 || write(fd, text.data(), text.size()) != static_cast<ssize_t>(text.size())) std::abort();
  close(fd);
  return path;
}

}  // namespace cerberus::tests
