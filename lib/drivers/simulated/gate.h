// SPDX-License-Identifier: LGPL-2.1-or-later
// A file descriptor that scripted drivers block on.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace cerberus::drivers {

// Until descriptor `fd` has something to read, or is closed by its writer. (Its number may be another's by then.)
inline void wait_at(int fd) {
  pollfd gate{::fcntl(fd, F_DUPFD_CLOEXEC, 0), POLLIN, 0};
  if (gate.fd < 0) return;
  while (::poll(&gate, 1, -1) < 0 && errno == EINTR) {
  }
  ::close(gate.fd);
}

}  // namespace cerberus::drivers
