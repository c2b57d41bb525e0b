// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/replay_sensor.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cerrno>
#include <cstring>
#include <utility>

namespace cerberus::drivers {

namespace {

constexpr off_t kLargest = 256 << 20;  // bytes: some weeks of readings

SensorError failed(const std::string& location, int error) {
  const SensorFault fault = error == ENOENT   ? SensorFault::not_found
                            : error == EACCES ? SensorFault::denied
                                              : SensorFault::gone;
  const char* help = fault == SensorFault::not_found ? " Set location to a file that is there."
                     : fault == SensorFault::denied  ? " Make sure that this user may read it."
                                                     : "";
  return {fault, "Cannot read the PIR recording " + location + ": " + std::strerror(error) + "." + help,
          errno_text(error)};
}

// All of a regular file: a pipe or a device could block. Returns errno, 0: good.
SensorError read_file(const std::string& location, std::string& text) {
  const int fd = ::open(location.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0) return failed(location, errno);
  SensorError error;
  struct stat about{};
  if (::fstat(fd, &about) != 0) {
    error = failed(location, errno);
  } else if (!S_ISREG(about.st_mode)) {
    error = {SensorFault::settings, "The PIR recording " + location + " is no regular file.", ""};
  } else if (about.st_size > kLargest) {
    error = {SensorFault::data,
             "The PIR recording " + location + " is larger than 256 MiB: cut it into pieces.", ""};
  } else {
    text.resize(static_cast<std::size_t>(about.st_size));
    std::size_t have = 0;
    while (have < text.size()) {
      const ssize_t got = ::read(fd, text.data() + have, text.size() - have);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) error = failed(location, errno);
      if (got <= 0) break;
      have += static_cast<std::size_t>(got);
    }
    text.resize(have);
  }
  ::close(fd);
  return error;
}

}  // namespace

SensorError ReplaySensor::open(const SensorSetup& setup) {
  close();
  if (setup.location.empty())
    return {SensorFault::settings, "No PIR recording to replay: name the file (location).", ""};
  std::string text;
  if (SensorError error = read_file(setup.location, text)) return error;
  Recording recording;
  if (SensorError error = parse_recording(text, setup.location, setup.sensors, recording)) return error;
  if (recording.edges.empty())
    return {SensorFault::data, "The PIR recording " + setup.location + " holds no readings.", ""};
  play(std::move(recording), setup.location, setup.level);
  return {};
}

}  // namespace cerberus::drivers
