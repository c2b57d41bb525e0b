// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads a whole text file that a user names. A wrong name never blocks the caller: pipes, devices and files larger
// than a limit are refused.
#pragma once

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <string>

namespace cerberus::text {

struct File {
  enum class Fault : std::uint8_t {
    none,
    failed,     // see `error`
    irregular,  // a pipe, a device, a folder
    too_large,
  };
  std::string text;
  Fault fault = Fault::none;
  int error = 0;  // errno
};

// Reads a regular file of at most `most` bytes. On failure `fault` gives the cause; never blocks.
inline File read_file(const std::string& path, std::size_t most) {
  File file;
  const auto failed = [&file] {
    file.fault = File::Fault::failed;
    file.error = errno;
  };
  // O_NONBLOCK: open() does not wait for a pipe's writer. O_NOCTTY: a terminal does not become the controlling terminal
  // of a daemon, which its Ctrl-C would end.
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0) {
    failed();
    return file;
  }
  struct stat about{};
  if (::fstat(fd, &about) != 0) {
    failed();
  } else if (!S_ISREG(about.st_mode)) {
    file.fault = File::Fault::irregular;
  } else if (static_cast<std::size_t>(about.st_size) > most) {
    file.fault = File::Fault::too_large;
  } else {
    file.text.resize(static_cast<std::size_t>(about.st_size));
    std::size_t have = 0;
    while (have < file.text.size()) {
      const ssize_t got = ::read(fd, file.text.data() + have, file.text.size() - have);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) failed();
      if (got <= 0) break;
      have += static_cast<std::size_t>(got);
    }
    file.text.resize(have);
  }
  ::close(fd);
  return file;
}

}  // namespace cerberus::text
