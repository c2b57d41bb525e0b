// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/stepper/stepper_axis.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::AxisLimits;
using sensing::degrees;
using sensing::radians;

struct Parameters {
  double back_off = radians(2);  // from the switch before the slow approach; more than its hysteresis
  double leave = radians(30);    // a switch that is still pressed after this way is broken
  double slow = 0.25;            // share of the homing speed in the approach, which decides the precision
  double extra_travel = 1.1;     // of the way between the limits: how far to look for a stop
  Time settle =
      std::chrono::milliseconds(20);  // the rotor's swing after its last step; guard: the unit test of stop
  Time idle = std::chrono::milliseconds(100);  // between two looks at an axis at rest
};
constexpr Parameters kParameters;

StepGeometry geometry_of(const StepperAxisOptions& options) {
  return {2 * std::numbers::pi / options.steps, options.backlash,
          Time(static_cast<Time::rep>(1e9 / options.max_rate))};
}

std::string in_degrees(double angle) {
  return text::significant(degrees(angle), 4).string();
}

}  // namespace

StepperAxis::StepperAxis(std::string name, const StepperAxisOptions& options, const MotorWiring& wiring,
                         std::optional<std::size_t> end_stop, std::optional<Time> release_delay, Time stale,
                         LinePort& port)
    : name_(std::move(name)),
      options_(options),
      schedule_(geometry_of(options)),
      motor_(wiring, port),
      port_(&port),
      end_stop_(end_stop),
      release_delay_(release_delay),
      stale_(stale) {}

double StepperAxis::side() const {
  return options_.home_at > 0 ? 1 : -1;
}

void StepperAxis::start(double angle, const AxisLimits& limits, Time now) {
  limits_ = limits;
  command_ = {};
  schedule_.place(angle);
  rest_since_ = now;
  referenced_ = !end_stop_ && !options_.hard_stop;
  if (referenced_) return;
  command_ = {AxisCommand::Kind::position, angle, limits.speed};
  begin_homing(now);
}

void StepperAxis::limit(const AxisLimits& limits, Time now) {
  limits_ = limits;
  if (!homing() && referenced_ && !stopping_) plan(command_, now);
}

void StepperAxis::command(const AxisCommand& command, Time now) {
  command_ = command;
  stopping_ = leaving_ = false;
  if (homing() || lost_) return;
  if (!referenced_) {
    // A hold moves nothing: an axis that lost its position looks for it only on the way to a commanded one.
    if (command.kind != AxisCommand::Kind::hold) begin_homing(now);
    return;
  }
  plan(command, now);
}

void StepperAxis::plan(const AxisCommand& command, Time now) {
  if (error_ != 0) return;
  const bool was_moving = schedule_.moving();
  schedule_.command(now, command, limits_);
  if (schedule_.moving())
    error_ = motor_.energise(schedule_.count());
  else if (was_moving)
    rest_since_ = now;
}

void StepperAxis::stop(Time now) {
  command_ = {};
  if (std::exchange(homing_, Homing::none) != Homing::none) referenced_ = false;
  AxisLimits limits = limits_;
  limits.acceleration =
      std::max(limits.acceleration, std::abs(schedule_.speed(now)) / motion::seconds(kStopTime));
  // An axis that homes may be anywhere, also beyond its limits.
  limits.from = std::min(limits.from, schedule_.load()) - radians(180);
  limits.to = std::max(limits.to, schedule_.load()) + radians(180);
  schedule_.command(now, {}, limits);
  stopping_ = energised();
  rest_since_ = now;
}

void StepperAxis::leave(Time now) {
  stop(now);
  leaving_ = stopping_;
}

void StepperAxis::release() noexcept {
  if (schedule_.moving() || homing()) referenced_ = !end_stop_ && !options_.hard_stop;
  homing_ = Homing::none;
  schedule_.cut();
  command_ = {};
  stopping_ = false;
  if (const int error = motor_.release(); error != 0 && error_ == 0) error_ = error;
}

void StepperAxis::recover() noexcept {
  error_ = 0;
  lost_ = false;
  referenced_ = !end_stop_ && !options_.hard_stop;
  release();
}

void StepperAxis::fail(std::string text, Time now) {
  fault_ = std::move(text);
  fault_end_ = now + kFaultTime;
}

bool StepperAxis::pressed() {
  bool level = false;
  if (const int error = port_->get(*end_stop_, level)) error_ = error;
  return error_ == 0 && level != options_.end_stop_low;
}

// Moves by `way` (radians) from here, whatever the limits: they are not known before the axis is homed.
void StepperAxis::seek(double way, double speed, Time now) {
  const double here = schedule_.load();
  AxisLimits anywhere = limits_;
  anywhere.from = std::min(here, here + way);
  anywhere.to = std::max(here, here + way);
  schedule_.command(now, {AxisCommand::Kind::position, here + way, speed}, anywhere);
  if (error_ == 0) error_ = motor_.energise(schedule_.count());
}

void StepperAxis::begin_homing(Time now) {
  const double travel = kParameters.extra_travel * (limits_.to - limits_.from);
  stopping_ = false;
  if (options_.hard_stop) {
    homing_ = Homing::pressing;
    return seek(side() * travel, options_.homing_speed, now);
  }
  if (pressed()) {
    homing_ = Homing::leaving;
    seek(-side() * kParameters.leave, options_.homing_speed, now);
  } else {
    homing_ = Homing::seeking;
    seek(side() * travel, options_.homing_speed, now);
  }
}

void StepperAxis::home(Time now) {
  if (homing_ == Homing::pressing) {
    if (!schedule_.moving()) finish_homing(now);
    return;
  }
  const bool there = pressed();
  const bool arrived = !schedule_.moving();
  const auto give_up = [&](const std::string& why) {
    release();
    referenced_ = false;
    lost_ = true;
    fail("the " + name_ + " axis did not find its end stop: " + why + ". Check the switch and its line", now);
  };
  switch (homing_) {
    case Homing::leaving:
      if (!there) {
        schedule_.cut();
        return begin_homing(now);
      }
      if (arrived) give_up("it stays pressed");
      return;
    case Homing::seeking:
    case Homing::approaching:
      if (there && homing_ == Homing::seeking) {
        schedule_.cut();
        homing_ = Homing::backing;
        return seek(-side() * kParameters.back_off, options_.homing_speed, now);
      }
      if (there) return finish_homing(now);
      if (arrived) give_up("it was not pressed within the limits of the axis");
      return;
    case Homing::backing:
      if (!arrived) return;
      if (there) return give_up("it stays pressed");
      homing_ = Homing::approaching;
      return seek(2 * side() * kParameters.back_off, kParameters.slow * options_.homing_speed, now);
    case Homing::none:
    case Homing::pressing:
      return;
  }
}

void StepperAxis::finish_homing(Time now) {
  schedule_.place(options_.home_at);
  homing_ = Homing::none;
  referenced_ = true;
  rest_since_ = now;
  plan(command_, now);
}

// A pressed end stop on the way towards it: the position was wrong.
void StepperAxis::obey_end_stop(Time now) {
  if (!end_stop_ || schedule_.direction() * side() <= 0 || !pressed()) return;
  const std::string thought = in_degrees(schedule_.load());
  schedule_.place(options_.home_at);
  command_ = {};
  rest_since_ = now;
  fail("the " + name_ + " axis reached its end stop at " + in_degrees(options_.home_at) +
           " degrees, and was taken to be at " + thought + ": steps were lost",
       now);
}

// Executes the next step if it is due. False: there is none.
bool StepperAxis::execute(Time now) {
  if (error_ != 0 || schedule_.next() > now) return false;
  if (now - schedule_.planned() > stale_) {
    const auto late = std::chrono::duration_cast<std::chrono::milliseconds>(now - schedule_.planned());
    schedule_.cut();
    if (std::exchange(homing_, Homing::none) != Homing::none) referenced_ = false;
    command_ = {};
    rest_since_ = now;
    fail("the " + name_ + " axis stopped: its next step was " + std::to_string(late.count()) +
             " ms late, and late steps are not caught up with. The machine is too busy",
         now);
    return false;
  }
  error_ = motor_.step(schedule_.count(), schedule_.direction());
  if (error_ != 0) return false;
  schedule_.advance(now);
  rest_since_ = now;
  return true;
}

Time StepperAxis::tick(Time now) {
  if (error_ == 0) {
    if (homing())
      home(now);
    else
      obey_end_stop(now);
    execute(now);
  }
  if (schedule_.moving()) return schedule_.next();
  if (homing()) return now;  // its next phase
  if (!energised()) {
    stopping_ = false;
    return now + kParameters.idle;
  }
  if (!stopping_ && !release_delay_) return now + kParameters.idle;
  const Time due = rest_since_ + std::max(kParameters.settle, stopping_ ? Time::zero() : *release_delay_);
  if (now < due) return std::min(due, now + kParameters.idle);
  stopping_ = false;
  const bool off = std::exchange(leaving_, false) || release_delay_;
  if (off && motor_.releases()) error_ = motor_.release();
  return now + kParameters.idle;
}

}  // namespace cerberus::drivers
