// SPDX-License-Identifier: LGPL-2.1-or-later
// A pan-tilt head of one or two hobby servos on a PWM chip (the driver servo-pwm). The angle is planned with the limits
// of speed and acceleration, and becomes a pulse width once a period. A servo tells nothing: its position is the planned
// one.
//
// After release_delay at rest the pulses end, so that the servos neither hum nor heat. They end and begin with whole
// pulses, and begin with the width that they ended with: a servo that was not turned meanwhile does not move.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "drivers/helper/head_device.h"
#include "drivers/servo/pwm_channel.h"
#include "drivers/servo/servo_options.h"

namespace cerberus::drivers {

class ServoHead final : public HeadDevice {
 public:
  explicit ServoHead(ServoOptions options) : options_(std::move(options)) {}
  ~ServoHead() override;

  std::string check() const override;
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  void release(Time now) noexcept override;
  bool stopping() const override { return !gone_ && (pan_.moves || tilt_.moves); }
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::string fault() const override { return fault_; }

  static constexpr std::chrono::milliseconds kStopTime{250};
  static constexpr std::chrono::milliseconds kReopen{1000};
  // Between two looks at the chip of a head at rest, which write nothing. derived: its loss is reported within 1 s
  static constexpr std::chrono::milliseconds kProbe{500};
  static constexpr double kRate = 50;  // commands a second

 private:
  struct Axis {
    ServoAxisOptions options;
    PwmChannel channel;
    motion::AxisLimits limits;
    motion::AxisCommand command;
    motion::Plan plan;
    Time width{};  // in force; 0: no pulses
    bool enabled = false, moves = false;
    bool begins = false;  // a motion from rest, of which no pulse was given yet
    bool known = false;   // a pulse was given: the servo is where the plan is
    Time rest_since{};
    int quiet_periods = 0;  // since the width became 0
    int error = 0;

    bool there() const { return options.channel >= 0; }
  };
  std::string open_axis(const char* name, Axis& axis, std::chrono::milliseconds patience);
  void order(Axis& axis, const motion::AxisCommand& command, Time now);
  void halt(Axis& axis, Time now) noexcept;
  void drive(Axis& axis, Time now);
  void end_pulses(Axis& axis) noexcept;
  void probe(Time now) noexcept;
  void set_limits(Axis& axis, const motion::AxisLimits& limits);

  ServoOptions options_;
  Axis pan_, tilt_;
  Time next_period_{}, next_open_{}, next_report_{}, next_probe_{};
  bool gone_ = false;
  std::string fault_;
};

}  // namespace cerberus::drivers
