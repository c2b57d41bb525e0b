// SPDX-License-Identifier: LGPL-2.1-or-later
// A file that a killed recorder left. It is never longer than before, and a second repair finds it sound.
#include "record/archive/mp4_repair.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

using namespace cerberus::record;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const int fd = memfd_create("mp4", MFD_CLOEXEC);
  if (fd < 0 || write(fd, data, size) != static_cast<ssize_t>(size)) std::abort();
  const Mp4State state = repair_mp4(fd);
  struct stat about{};
  if (state == Mp4State::failed || fstat(fd, &about) != 0 || static_cast<std::size_t>(about.st_size) > size)
    std::abort();
  if (state == Mp4State::repaired && repair_mp4(fd) != Mp4State::sound) std::abort();
  close(fd);
  return 0;
}
