// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/transport/stream_device.h"

#include <utility>

namespace cerberus::drivers {

void StreamDevice::watch(std::vector<pollfd>& fds) const {
  const int fd = stream_.is_open() ? stream_.fd() : connector_.fd();
  if (fd >= 0) fds.push_back({fd, POLLIN, 0});
}

std::string StreamDevice::connect(const HeadSetup& setup, Time now) {
  limits_ = setup.limits;
  reckoned_.begin(now, {setup.pan, setup.tilt});
  if (std::string wrong = stream_.open(device_, baud_); !wrong.empty()) return wrong;
  connected_ = true;
  on_connected(now);
  return {};
}

bool StreamDevice::is_there(Time now, Time& next) {
  if (stream_.is_open()) return true;
  next = now + std::chrono::milliseconds(50);
  if (std::exchange(connected_, false)) tried_ = now;  // reported before it is tried again
  fault_ = "the " + name_ + " at " + device_ + " is gone";
  if (!connector_.busy()) {
    if (now - tried_ < kReconnect) return false;
    tried_ = now;
    connector_.start(device_, baud_);
  }
  const auto over = connector_.take(stream_);
  if (!over || !over->empty()) return false;
  connected_ = true;
  on_connected(now);
  return stream_.is_open();
}

void StreamDevice::set_silent(bool silent, Time now, const char* advice) {
  if (!silent) return fault_.clear();
  if (!fault_.empty()) return;
  fault_ = "the " + name_ + " at " + device_ + " does not answer" + advice;
  stop(now);
}

std::optional<SpeedsLine> StreamDevice::take_speeds(Time now) {
  const auto speeds = reckoned_.take_speeds(now);
  return reports_ ? std::nullopt : speeds;
}

motion::PanTilt StreamDevice::confined(const motion::PanTilt& speed, const motion::PanTilt& measured,
                                       Time now) const {
  return reckoned_.confined(speed, measured, limits_, Parameters{}.reaction, now);
}

}  // namespace cerberus::drivers
