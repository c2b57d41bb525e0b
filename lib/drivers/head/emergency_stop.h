// SPDX-License-Identifier: LGPL-2.1-or-later
// A head with an emergency stop: a normally closed contact between a line that is pulled up and ground. An open contact
// or a broken wire releases the motors, whatever the head does, and keeps them released. A head that moved when the
// contact opened does not go on when it closes: the next `move` after that is obeyed.
#pragma once

#include <memory>
#include <string>

#include "drivers/helper/head_device.h"
#include "drivers/stepper/line_port.h"

namespace cerberus::drivers {

class EmergencyStop final : public HeadDevice {
 public:
  // line: name or number of the line in `port`, which is not open yet.
  EmergencyStop(HeadDevice& device, std::unique_ptr<LinePort> port, std::string line)
      : device_(device), port_(std::move(port)), line_(std::move(line)) {}

  std::string check() const override { return device_.check(); }
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override { return device_.abilities(); }
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  // A device that is released stays so: its stop would brake with its motors.
  void stop(Time now) noexcept override { open_ ? device_.release(now) : device_.stop(now); }
  void leave(Time now) noexcept override { open_ ? device_.release(now) : device_.leave(now); }
  void release(Time now) noexcept override { device_.release(now); }
  bool busy() const override { return device_.busy(); }
  bool stopping() const override { return device_.stopping(); }
  void watch(std::vector<pollfd>& fds) const override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override { return device_.take_pose(now); }
  bool emergency() const override { return open_; }
  std::optional<SpeedsLine> take_speeds(Time now) override { return device_.take_speeds(now); }
  std::optional<double> take_zoom() override { return device_.take_zoom(); }
  void zoom(double position, Time now) override {
    if (!open_) device_.zoom(position, now);
  }
  void home(Time now) override {
    if (!open_) device_.home(now);
  }
  std::optional<HomedLine> take_homed(Time now) override { return device_.take_homed(now); }
  std::string fault() const override;

  // Where the kernel reports no edge the line is read this often.
  static constexpr std::chrono::milliseconds kPeriod{5};
  // The contact bounces: it counts as closed again after this time.
  static constexpr std::chrono::milliseconds kClosed{50};
  // A line that cannot be read is requested again this often.
  static constexpr std::chrono::milliseconds kReopen{1000};

 private:
  void reopen(Time now);

  HeadDevice& device_;
  std::unique_ptr<LinePort> port_;
  std::string line_;
  bool open_ = false;  // the contact, or nothing is known of it
  Time open_until_{}, next_open_{};
  int error_ = 0;
};

}  // namespace cerberus::drivers
