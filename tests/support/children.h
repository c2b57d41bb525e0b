// SPDX-License-Identifier: LGPL-2.1-or-later
// The processes that this one has started.
#pragma once

#include <sys/types.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace cerberus::tests {

// Those of this name, as /proc has it (its first 15 characters).
inline std::vector<pid_t> children(const std::string& name) {
  std::vector<pid_t> found;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
    const long pid = std::strtol(entry.path().filename().c_str(), nullptr, 10);
    if (pid <= 0) continue;
    std::ifstream status(entry.path() / "status");
    bool named = false, own = false;
    for (std::string line; std::getline(status, line);) {
      named = named || line == "Name:\t" + name.substr(0, 15);
      own = own || line == "PPid:\t" + std::to_string(::getpid());
    }
    if (named && own) found.push_back(static_cast<pid_t>(pid));
  }
  return found;
}

// How many processes of this machine have this command line, its words parted by zeros.
inline int running(const std::string& words) {
  int count = 0;
  std::error_code gone;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", gone)) {
    std::ifstream file(entry.path() / "cmdline");
    const std::string line{std::istreambuf_iterator<char>(file), {}};
    count += line == words + std::string(1, 0);
  }
  return count;
}

}  // namespace cerberus::tests
