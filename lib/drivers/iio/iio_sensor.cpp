// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/iio/iio_sensor.h"

#include <iio.h>
#include <sys/timerfd.h>
#include <unistd.h>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace cerberus::drivers {

namespace {

const char* name_of(const iio_device* device) {
  const char* name = iio_device_get_name(device);
  return name ? name : "";
}

std::string devices_of(const iio_context* context) {
  std::string list;
  for (unsigned i = 0; i < iio_context_get_devices_count(context); ++i) {
    const iio_device* device = iio_context_get_device(context, i);
    const std::string id = iio_device_get_id(device);
    if (!id.starts_with("iio:device")) continue;  // a trigger
    list.append(list.empty() ? "" : ", ").append(id).append(" (").append(name_of(device)).append(")");
  }
  return list.empty() ? "This machine has no IIO device." : "There are: " + list + ".";
}

std::string channels_of(const iio_device* device) {
  std::string list;
  for (unsigned i = 0; i < iio_device_get_channels_count(device); ++i) {
    const iio_channel* channel = iio_device_get_channel(device, i);
    const std::string id = iio_channel_get_id(channel);
    if (iio_channel_is_output(channel) || !id.starts_with("voltage")) continue;
    list.append(list.empty() ? "" : ", ").append(id);
  }
  return list.empty() ? "It has no voltage channels." : "It has: " + list + ".";
}

// Returns errno; 0: no error, or the channel has no such attribute.
int read_if_there(const iio_channel* channel, const char* attribute, double& value) {
  if (!iio_channel_find_attr(channel, attribute)) return 0;
  const int result = iio_channel_attr_read_double(channel, attribute, &value);
  return result < 0 ? -result : 0;
}

int start_timer(Time interval) {
  const int timer = ::timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK | TFD_CLOEXEC);
  if (timer < 0) return -1;
  constexpr Time::rep second = 1'000'000'000;
  const timespec step{static_cast<time_t>(interval.count() / second),
                      static_cast<long>(interval.count() % second)};
  const itimerspec every{step, step};
  if (::timerfd_settime(timer, 0, &every, nullptr) == 0) return timer;
  ::close(timer);
  return -1;
}

}  // namespace

// Measures the input's voltage. Returns errno; 0: no error.
int IioSensor::volts(const Input& input, double& volts) {
  double raw = 0;
  if (const int error = iio_channel_attr_read_double(input.channel, "raw", &raw); error < 0) return -error;
  volts = (raw + input.offset) * input.scale / 1000;
  return 0;
}

SensorError IioSensor::find_channels(const SensorSetup& setup) {
  const iio_device* device = iio_context_find_device(context_, setup.device.c_str());
  if (!device)
    return {SensorFault::not_found,
            "There is no IIO device \"" + setup.device + "\". " + devices_of(context_), ""};
  device_ = iio_device_get_id(device);
  for (const std::string& number : setup.channels) {
    const std::string id = "voltage" + number;
    iio_channel* channel = iio_device_find_channel(device, id.c_str(), false);
    if (!channel || !iio_channel_find_attr(channel, "raw"))
      return {SensorFault::not_found,
              "IIO device " + device_ + " (" + name_of(device) + ") has no channel " + id + " to read. " +
                  channels_of(device),
              ""};
    // The raw values of a converter without a scale are millivolts.
    inputs_.push_back({channel, 1, 0, sensing::LevelSwitch(setup.level)});
    Input& input = inputs_.back();
    double ignored = 0;
    int error = read_if_there(channel, "scale", input.scale);
    if (!error) error = read_if_there(channel, "offset", input.offset);
    if (!error) error = volts(input, ignored);
    if (error) return gone(inputs_.size() - 1, error);
  }
  return {};
}

SensorError IioSensor::check(const SensorSetup& setup) const {
  if (setup.channels.size() != static_cast<std::size_t>(setup.sensors))
    return {SensorFault::settings,
            "Name one IIO channel for each of the " + std::to_string(setup.sensors) +
                " sensors (channels); " + std::to_string(setup.channels.size()) + " are named.",
            ""};
  return {};
}

SensorError IioSensor::open(const SensorSetup& setup) {
  close();
  if (SensorError error = check(setup)) return error;
  errno = 0;
  context_ = iio_create_local_context();
  if (!context_)
    return {SensorFault::not_found,
            "There is no IIO device \"" + setup.device + "\": this machine has no IIO devices at all.",
            errno_text(errno)};
  if (SensorError error = find_channels(setup)) {
    close();
    return error;
  }
  timer_ = start_timer(setup.interval);
  if (timer_ < 0) {
    const int error = errno;
    close();
    return {SensorFault::gone, "No timer for sampling IIO device " + setup.device + ".", errno_text(error)};
  }
  return {};
}

void IioSensor::close() noexcept {
  if (timer_ >= 0) ::close(timer_);
  timer_ = -1;
  inputs_.clear();
  if (context_) iio_context_destroy(context_);
  context_ = nullptr;
  begun_ = false;
}

SensorError IioSensor::gone(std::size_t input, int error) const {
  const std::string what = place(static_cast<int>(input));
  if (error == EACCES || error == EPERM)
    return {SensorFault::denied, "No permission to read " + what + ": let a udev rule allow it.",
            errno_text(error)};
  return {SensorFault::gone, "Cannot read " + what + " (" + std::strerror(error) + "): was it unplugged?",
          errno_text(error)};
}

SensorError IioSensor::read(Time now, std::vector<SensorEdge>& edges) {
  if (timer_ < 0) return {SensorFault::gone, "The IIO device is not open.", ""};
  std::uint64_t ticks = 0;
  const bool due = ::read(timer_, &ticks, sizeof ticks) == static_cast<ssize_t>(sizeof ticks);
  if (!due && begun_) return {};
  for (std::size_t i = 0; i < inputs_.size(); ++i) {
    Input& input = inputs_[i];
    double measured = 0;
    if (const int error = volts(input, measured)) return gone(i, error);
    edges.push_back({now, static_cast<int>(i), input.level.update(measured), static_cast<float>(measured)});
  }
  begun_ = true;
  return {};
}

std::string IioSensor::place(int sensor) const {
  const auto i = static_cast<std::size_t>(sensor);
  return i < inputs_.size() ? std::string(iio_channel_get_id(inputs_[i].channel)) + " of " + device_
                            : "IIO channel";
}

}  // namespace cerberus::drivers
