// SPDX-License-Identifier: LGPL-2.1-or-later
// What head devices on a ByteStream share: the connection, which is made again once a second while the device is gone;
// its faults; and the limits, which hold by the device's positions or, without these, by the speeds that it was sent.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/helper/head_device.h"
#include "drivers/helper/speed_reckoning.h"
#include "drivers/transport/byte_stream.h"
#include "drivers/transport/connector.h"

namespace cerberus::drivers {

class StreamDevice : public HeadDevice {
 public:
  void watch(std::vector<pollfd>& fds) const override;
  std::string fault() const override { return fault_; }
  std::optional<SpeedsLine> take_speeds(Time now) override;

  static constexpr std::chrono::milliseconds kReconnect{1000};

 protected:
  struct Parameters {
    // Seconds of way for which a head is stopped before a limit. derived: a position is 100 ms old, and a stop takes
    // half as long to arrive.
    double reaction = 0.15;
  };

  // name: for messages, as "VISCA camera".
  StreamDevice(std::string name, std::string device, int baud)
      : name_(std::move(name)), device_(std::move(device)), baud_(baud) {}
  // What connect() refuses of the device's address and baud rate alone.
  std::string check_device() const { return ByteStream::check(device_, baud_); }
  // Opens the device. Blocks as ByteStream::open(); what tick() does afterwards never blocks.
  std::string connect(const HeadSetup& setup, Time now);
  // For tick(): whether the device is there. If it is not, `next` is when to call again. Calls on_connected() when the
  // device has returned.
  bool is_there(Time now, Time& next);
  // A new connection: forgets what was on its way, greets the device and stops it.
  virtual void on_connected(Time now) = 0;
  // Reports a device that should have answered and has not, and stops it once. advice: what the user may do.
  void set_silent(bool silent, Time now, const char* advice = "");

  // "VISCA camera at serial:/dev/ttyUSB0"
  std::string title() const { return name_ + " at " + device_; }

  // The device turns at these speeds (radians a second) from now on.
  void set_speeds(const motion::PanTilt& speed, Time now) { reckoned_.set_speeds(speed, now); }
  // A stop is sent to the device; it has obeyed the one that was sent at `sent`, and none before.
  void set_stopped(Time now) { reckoned_.stop(now); }
  void on_stopped(Time sent) { reckoned_.on_stopped(sent); }
  // The device was found to be at `at`: its reckoning begins anew there.
  void set_reference(const motion::PanTilt& at, Time now) { reckoned_.set_reference(at, now); }
  // speed (radians a second), or 0 where it would lead beyond a limit. measured: the position that the device reported,
  // NaN without one.
  motion::PanTilt confined(const motion::PanTilt& speed, const motion::PanTilt& measured, Time now) const;

  ByteStream stream_;
  motion::Limits limits_;
  std::string fault_;
  bool reports_ = false;  // positions: its speeds are of no interest

 private:
  std::string name_, device_;
  int baud_;
  Connector connector_;
  bool connected_ = false;  // the last time that tick() looked
  Time tried_{};
  SpeedReckoning reckoned_;
};

}  // namespace cerberus::drivers
