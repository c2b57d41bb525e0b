// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/external/external_sensor.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "drivers/helper/option_words.h"
#include "drivers/helper/program_check.h"
#include "drivers/transport/exclusive.h"
#include "text/numbers.h"

namespace cerberus::drivers {

namespace {

constexpr std::string_view kSerial = "serial:";
constexpr double kMostSilence = 3600;  // seconds

SensorError open_fifo(const std::string& path, int& fd) {
  struct stat about{};
  // Opened for both directions: the end of one writer is not the end of the input, and a poll does not spin on it.
  fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
  const int error = errno;
  if (fd >= 0 && ::fstat(fd, &about) == 0 && S_ISFIFO(about.st_mode)) {
    if (lock_device(fd) == 0) return {};
    ::close(std::exchange(fd, -1));  // of two readers each would get some of the lines
    return {SensorFault::busy, "The FIFO " + path + " is read by " + program_with(path) + ": end that first.",
            errno_text(EBUSY)};
  }
  if (fd >= 0) {
    ::close(std::exchange(fd, -1));
    return {SensorFault::settings,
            path + " is no FIFO: make one with mkfifo, or write serial:" + path + " for a serial port.", ""};
  }
  const bool denied = error == EACCES || error == EPERM;
  return {denied ? SensorFault::denied : SensorFault::not_found,
          "The FIFO " + path + " cannot be opened: " + std::strerror(error) +
              (denied ? "; its reader needs to be allowed to write, too." : "."),
          errno_text(error)};
}

}  // namespace

SensorError ExternalSensor::read_options(const std::string& options, Options& into) {
  for (const OptionWord& word : option_words(options)) {
    const auto number = number_of(word.value);
    if (word.key == "baud" && number && *number >= 1 && *number <= 1e6) {
      into.baud = static_cast<int>(*number);
    } else if (word.key == "silence" && number && *number >= 0 && *number <= kMostSilence) {
      into.silence = std::chrono::duration_cast<Time>(std::chrono::duration<double>(*number));
    } else if (word.key == "volts" && !word.has_value) {
      into.measures = true;
    } else {
      return {SensorFault::settings,
              "\"" + word.key + (word.has_value ? "=" + word.value : "") +
                  "\" is no option of external sensors (device-options): baud=N, silence=SECONDS (0 to "
                  "3600), volts.",
              ""};
    }
  }
  return {};
}

SensorError ExternalSensor::connect() {
  lines_.clear();
  heard_.reset();
  garbled_ = false;
  if (!command_.empty()) {
    const std::string wrong = process_.start({"/bin/sh", "-c", command_});
    return wrong.empty() ? SensorError{} : SensorError{SensorFault::gone, described(wrong) + ".", ""};
  }
  if (!device_.starts_with(kSerial)) return open_fifo(device_, fifo_);
  errno = 0;
  const std::string wrong = serial_.open(device_, options_.baud);
  const int error = errno;
  if (wrong.empty()) return {};
  const auto fault = error == 0        ? SensorFault::settings
                     : error == EACCES ? SensorFault::denied
                     : error == EBUSY  ? SensorFault::busy
                                       : SensorFault::not_found;
  return {fault, described(wrong) + ".", ""};
}

SensorError ExternalSensor::check(const SensorSetup& setup) const {
  if (setup.command.empty() == setup.device.empty())
    return {
        SensorFault::settings,
        "External sensors need either a command or a device (serial:/dev/ttyUSB0, or the path of a FIFO).",
        ""};
  Options options;
  if (SensorError error = read_options(setup.options, options)) return error;
  if (setup.command.empty()) {
    const std::string wrong =
        setup.device.starts_with(kSerial) ? ByteStream::check(setup.device, options.baud) : "";
    return wrong.empty() ? SensorError{} : SensorError{SensorFault::settings, wrong + " (device).", ""};
  }
  const std::string wrong = command_fault(setup.command);
  return wrong.empty() ? SensorError{}
                       : SensorError{SensorFault::settings, "The command: " + wrong + ".", ""};
}

SensorError ExternalSensor::open(const SensorSetup& setup) {
  close();
  if (SensorError error = check(setup)) return error;
  options_ = {};
  read_options(setup.options, options_);
  command_ = setup.command;
  device_ = setup.device;
  name_ = command_.empty() ? device_ : "the command \"" + command_ + "\"";
  sensors_ = setup.sensors;
  switches_.assign(static_cast<std::size_t>(sensors_), sensing::LevelSwitch(setup.level));
  if (SensorError error = connect()) {
    close();
    return error;
  }
  open_ = true;
  return {};
}

void ExternalSensor::disconnect() noexcept {
  // The command's process group: a shell does not pass the signal on to what it runs.
  if (process_.running() && process_.pid() > 0) ::kill(-process_.pid(), SIGTERM);
  process_.hang_up();
  serial_.close();
  if (fifo_ >= 0) ::close(std::exchange(fifo_, -1));
}

void ExternalSensor::close() noexcept {
  disconnect();
  process_.finish();
  open_ = known_ = accepted_ = false;
  outage_.clear();
}

int ExternalSensor::fd() const {
  if (process_.running()) return process_.fd();
  return serial_.is_open() ? serial_.fd() : fifo_;
}

std::string ExternalSensor::described(const std::string& why) const {
  return "PIR sensors of " + name_ + ": " + why;
}

void ExternalSensor::forget_levels(Time now, bool restarts, std::vector<SensorEdge>& edges) {
  if (!std::exchange(known_, false)) return;
  for (int i = 0; i < sensors_; ++i)
    edges.push_back({.time = now, .sensor = i, .known = false, .restarts = restarts});
}

void ExternalSensor::lose(Time now, std::string why, std::vector<SensorEdge>& edges) {
  disconnect();
  tried_ = now;
  outage_ = described(why);
  forget_levels(now, true, edges);
}

void ExternalSensor::on_levels(const SensorLevels& found, Time now, std::vector<SensorEdge>& edges) {
  for (int i = 0; i < sensors_; ++i) {
    const auto at = static_cast<std::size_t>(i);
    SensorEdge edge{.time = now, .sensor = i};
    if (found.measured) {
      edge.known = !std::isnan(found.volts[at]);
      edge.level = switches_[at].update(found.volts[at]);
      if (options_.measures) edge.volts = found.volts[at];
    } else {
      edge.known = found.levels[at].has_value();
      edge.level = found.levels[at].value_or(false);
    }
    edges.push_back(edge);
  }
  known_ = accepted_ = true;
  outage_.clear();
}

// An error is one of the settings, which no waiting mends.
SensorError ExternalSensor::on_line(const SensorLine& line, Time now, std::vector<SensorEdge>& edges) {
  int count = sensors_;
  if (const auto* hello = std::get_if<SensorHello>(&line)) {
    if (hello->version != kSensorProtocol && accepted_) return {};  // a damaged line
    if (hello->version != kSensorProtocol)
      return {SensorFault::settings,
              described("they speak version " + std::to_string(hello->version) +
                        " of the line protocol, and this Cerberus speaks version " +
                        std::to_string(kSensorProtocol) + "."),
              ""};
    count = hello->sensors;
  }
  const auto* levels = std::get_if<SensorLevels>(&line);
  if (levels) count = levels->count;
  if (count != sensors_) {
    if (accepted_) return {};  // a damaged line
    return {SensorFault::settings,
            described("there are " + std::to_string(count) + ", and " + std::to_string(sensors_) +
                      " bearings are set: name one for each sensor (bearings)."),
            ""};
  }
  if (levels) on_levels(*levels, now, edges);
  if (const auto* fault = std::get_if<SensorFaultText>(&line)) {
    outage_ = described(fault->text.empty() ? "they fail" : fault->text);
    forget_levels(now, false, edges);
  }
  return {};
}

// Reads what has come, a piece at a time: the next read() takes the rest of a flood.
SensorError ExternalSensor::take(Time now, std::vector<SensorEdge>& edges) {
  std::array<char, 4096> piece;
  const ssize_t got = ::read(fd(), piece.data(), piece.size());
  const int error = errno;
  if (got > 0) lines_.append({piece.data(), static_cast<std::size_t>(got)});
  garbled_ = garbled_ || got > 0;
  while (const auto text = lines_.take()) {
    const auto line = parse_sensor_line(*text);
    if (!line) continue;
    heard_ = now;
    garbled_ = false;
    if (SensorError wrong = on_line(*line, now, edges)) return wrong;
  }
  if (got > 0 || (got < 0 && (error == EAGAIN || error == EINTR))) return {};
  if (command_.empty())
    lose(now, "the device is gone; it is used again when it returns", edges);
  else
    lose(now, "it has ended; it is started again", edges);
  return {};
}

SensorError ExternalSensor::read(Time now, std::vector<SensorEdge>& edges) {
  if (!open_) return {SensorFault::gone, "The external sensors are not open.", ""};
  if (fd() < 0) {
    if (now - tried_ < kReopen) return {};
    tried_ = now;
    if (connect()) return {};
  }
  if (SensorError wrong = take(now, edges)) return wrong;
  if (!heard_) heard_ = now;
  if (options_.silence > Time::zero() && now - *heard_ >= options_.silence && fd() >= 0) {
    heard_ = now;
    const double seconds = std::chrono::duration<double>(options_.silence).count();
    outage_ = described("no line of the protocol has come for " + text::rounded(seconds, 3).string() +
                        (garbled_ ? " s, but other bytes: check the baud rate (device-options)" : " s"));
    forget_levels(now, false, edges);
  }
  return {};
}

std::string ExternalSensor::place(int sensor) const {
  return sensor >= 0 && sensor < sensors_ ? "sensor " + std::to_string(sensor + 1) + " of " + name_
                                          : "external sensor";
}

}  // namespace cerberus::drivers
