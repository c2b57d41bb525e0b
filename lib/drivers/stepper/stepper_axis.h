// SPDX-License-Identifier: LGPL-2.1-or-later
// One axis with a stepper motor: executes its schedule, homes it, switches the motor off at rest. No clock: time is
// CLOCK_MONOTONIC as a parameter.
//
// A step whose planned deadline is missed by more than `stale` is not executed: the rest of the schedule is dropped, the
// axis rests where it is, and that is a fault, since replaying steps in a burst loses them.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "drivers/stepper/motor_lines.h"
#include "drivers/stepper/step_schedule.h"
#include "drivers/stepper/stepper_options.h"

namespace cerberus::drivers {

class StepperAxis {
 public:
  // name: "pan" or "tilt", for messages. end_stop: index of its input in the port.
  StepperAxis(std::string name, const StepperAxisOptions& options, const MotorWiring& wiring,
              std::optional<std::size_t> end_stop, std::optional<Time> release_delay, Time stale,
              LinePort& port);

  // The axis looks along `angle` (radians), or homes first and then goes there.
  void start(double angle, const motion::AxisLimits& limits, Time now);
  void limit(const motion::AxisLimits& limits, Time now);
  // While the axis homes, the newest command waits. An axis that needs homing begins it with a command that moves.
  void command(const motion::AxisCommand& command, Time now);
  // Brakes within kStopTime, lets the rotor settle and switches the motor off, unless its release_delay is never.
  void stop(Time now);
  // The same, and switches the motor off in any case.
  void leave(Time now);
  // Switches the motor off at once. A moving motor loses its position: an axis that can home does so before it moves
  // again.
  void release() noexcept;
  // The lines were lost and are there again: as after release().
  void recover() noexcept;
  // Executes what is due. Returns when it must be called again at the latest.
  Time tick(Time now);

  bool moving() const { return schedule_.moving(); }
  bool homing() const { return homing_ != Homing::none; }
  bool energised() const { return motor_.energised(); }
  bool stopping() const { return stopping_; }
  motion::AxisState state(Time now) const { return {schedule_.load(), schedule_.speed(now), 0}; }
  const StepSchedule& schedule() const { return schedule_; }
  int error() const { return error_; }  // errno of the port, 0 = none
  // What went wrong in the last kFaultTime, or why the axis cannot be homed; empty: nothing.
  std::string fault(Time now) const { return lost_ || now < fault_end_ ? fault_ : std::string(); }

  static constexpr std::chrono::milliseconds kStopTime{
      250};  // half of the 500 ms that a silent pipeline gets
  static constexpr std::chrono::milliseconds kFaultTime{500};

 private:
  enum class Homing { none, leaving, seeking, backing, approaching, pressing };

  void plan(const motion::AxisCommand& command, Time now);
  void begin_homing(Time now);
  void home(Time now);
  void finish_homing(Time now);
  void seek(double way, double speed, Time now);
  void obey_end_stop(Time now);
  void fail(std::string text, Time now);
  bool pressed();
  bool execute(Time now);
  double side() const;

  std::string name_;
  StepperAxisOptions options_;
  StepSchedule schedule_;
  MotorLines motor_;
  LinePort* port_;
  std::optional<std::size_t> end_stop_;
  std::optional<Time> release_delay_;  // nullopt: never
  Time stale_;
  motion::AxisLimits limits_;
  motion::AxisCommand command_;  // the caller's
  Homing homing_ = Homing::none;
  bool referenced_ = false;  // no homing is needed
  bool lost_ = false;        // homing failed: the axis does not move until recover()
  bool stopping_ = false;
  bool leaving_ = false;     // stopping, and to be switched off whatever the release_delay
  double homing_start_ = 0;  // radians
  Time rest_since_{}, fault_end_{};
  std::string fault_;
  int error_ = 0;
};

}  // namespace cerberus::drivers
