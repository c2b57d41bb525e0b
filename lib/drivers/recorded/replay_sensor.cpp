// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/recorded/replay_sensor.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include "text/file.h"

namespace cerberus::drivers {

namespace {

constexpr std::size_t kLargest = 256 << 20;  // bytes: some weeks of readings

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

SensorError fault_of(const text::File& file, const std::string& location) {
  using Fault = text::File::Fault;
  switch (file.fault) {
    case Fault::failed:
      return failed(location, file.error);
    case Fault::irregular:
      return {SensorFault::settings, "The PIR recording " + location + " is no regular file.", ""};
    case Fault::too_large:
      return {SensorFault::data,
              "The PIR recording " + location + " is larger than 256 MiB: cut it into pieces.", ""};
    case Fault::none:
      break;
  }
  return {};
}

}  // namespace

SensorError ReplaySensor::open(const SensorSetup& setup) {
  close();
  if (setup.location.empty())
    return {SensorFault::settings, "No PIR recording to replay: name the file (location).", ""};
  const text::File file = text::read_file(setup.location, kLargest);
  if (SensorError error = fault_of(file, setup.location)) return error;
  Recording recording;
  if (SensorError error = parse_recording(file.text, setup.location, setup.sensors, recording)) return error;
  if (recording.edges.empty())
    return {SensorFault::data, "The PIR recording " + setup.location + " holds no readings.", ""};
  play(std::move(recording), setup.location, setup.level);
  return {};
}

}  // namespace cerberus::drivers
