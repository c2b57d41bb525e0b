// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/transport/exclusive.h"

#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace cerberus::drivers {
namespace {

namespace fs = std::filesystem;

// Of /proc/locks (proc(5)): "1: FLOCK  ADVISORY  WRITE 1234 08:01:5678 0 EOF". 0: no process holds one.
long locker(const struct stat& device) {
  char place[64];
  std::snprintf(place, sizeof place, "%02x:%02x:%llu", major(device.st_dev), minor(device.st_dev),
                static_cast<unsigned long long>(device.st_ino));
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number, kind, advisory, mode, where;
    long process = 0;
    if (words >> number >> kind >> advisory >> mode >> process >> where && kind == "FLOCK" && where == place)
      return process;
  }
  return 0;
}

// Reads the descriptors of the processes that this one may inspect. 0: none of these has the device open.
long opener(const struct stat& device) {
  std::error_code wrong;
  for (const fs::directory_entry& entry : fs::directory_iterator("/proc", wrong)) {
    const std::string name = entry.path().filename();
    long process = 0;
    const auto read = std::from_chars(name.data(), name.data() + name.size(), process);
    if (read.ec != std::errc() || read.ptr != name.data() + name.size() || process == ::getpid()) continue;
    for (const fs::directory_entry& fd : fs::directory_iterator(entry.path() / "fd", wrong)) {
      struct stat opened{};
      if (::stat(fd.path().c_str(), &opened) == 0 && opened.st_dev == device.st_dev &&
          opened.st_ino == device.st_ino)
        return process;
    }
  }
  return 0;
}

}  // namespace

int lock_device(int fd) noexcept {
  return ::flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK ? EBUSY : 0;
}

std::string program_with(const std::string& path) {
  std::string program = "another program";
  struct stat device{};
  if (::stat(path.c_str(), &device) != 0) return program;
  long process = locker(device);
  if (process <= 0) process = opener(device);
  if (process <= 0) return program;
  std::string name;
  std::getline(std::ifstream("/proc/" + std::to_string(process) + "/comm"), name);
  program += " (process " + std::to_string(process);
  if (!name.empty()) program += ", " + name;
  return program + ")";
}

}  // namespace cerberus::drivers
