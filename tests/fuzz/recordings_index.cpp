// SPDX-License-Identifier: LGPL-2.1-or-later
// The file of an index of recordings, which may be damaged or another program's: it is read or refused, and no row leads
// to a file outside the folder. Only by libFuzzer: each input is a file on a disk.
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "record/archive/archive.h"

using namespace cerberus::record;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // In memory where there is such a disk: every row is synchronised.
  static const std::string folder = (std::filesystem::exists("/dev/shm") ? "/dev/shm" : "/tmp") +
                                    ("/cerberus-fuzz-index-" + std::to_string(getpid()));
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder + "/in");
  std::ofstream(folder + "/precious.mp4") << "x";
  std::ofstream(folder + "/in/index.sqlite", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  Archive archive;
  archive.open({folder + "/in", "index.sqlite", {Time(1), 1, UINT64_MAX}},
               {std::chrono::days(40'000), Time(0), 0});
  archive.retain({std::chrono::days(40'000), std::chrono::hours(3), 0});
  archive.close();
  if (!std::filesystem::exists(folder + "/precious.mp4")) std::abort();
  return 0;
}
