// SPDX-License-Identifier: LGPL-2.1-or-later
// Waiting at a file descriptor, by which scripted drivers block.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>

namespace cerberus::drivers {

// Blocks until descriptor `fd` is readable or closed by its writer. It waits at a duplicate, because the number may be
// reused meanwhile.
inline void wait_at(int fd) {
  pollfd gate{::fcntl(fd, F_DUPFD_CLOEXEC, 0), POLLIN, 0};
  if (gate.fd < 0) return;
  while (::poll(&gate, 1, -1) < 0 && errno == EINTR) {
  }
  ::close(gate.fd);
}

}  // namespace cerberus::drivers
