// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/stepper/step_schedule.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::AxisState;

// Nearer than this (a share of a step) counts as reached: rounding of the division by the step.
constexpr double kTie = 1e-6;

// Where the command brings a load that is at `state`; nullopt: it brakes, and stays where that ends.
std::optional<double> target_of(const AxisCommand& command, double rest, const motion::AxisLimits& limits) {
  const bool sane = std::isfinite(command.value) && std::isfinite(command.speed);
  if (command.kind == AxisCommand::Kind::position && sane && command.speed > 0)
    return limits.clamp(command.value);
  if (command.kind == AxisCommand::Kind::velocity && sane && command.value != 0)
    return command.value > 0 ? limits.to : limits.from;
  if (limits.holds(rest)) return std::nullopt;
  return limits.clamp(rest);  // beyond the limits: back to them
}

double speed_of(const AxisCommand& command, const motion::AxisLimits& limits) {
  if (command.kind == AxisCommand::Kind::position && command.speed > 0 && std::isfinite(command.value))
    return command.speed;
  if (command.kind == AxisCommand::Kind::velocity && command.value != 0) return std::abs(command.value);
  return limits.speed;
}

// The whole number of steps nearest to `target` that lies between the limits, as an angle.
double whole_steps(double target, double step, const motion::AxisLimits& limits) {
  const double least = std::ceil(limits.from / step - kTie), most = std::floor(limits.to / step + kTie);
  return least <= most ? std::clamp(std::round(target / step), least, most) * step : target;
}

}  // namespace

void StepSchedule::place(double angle) {
  const double lead = load_ - motor();
  load_ = angle;
  origin_ = angle - lead - static_cast<double>(count_) * geometry_.step;
  cut();
}

void StepSchedule::cut() {
  plan_ = motion::Plan(motor() - origin_);
  direction_ = 0;
  next_ = motion::kNever;
}

void StepSchedule::command(Time now, const AxisCommand& command, const motion::AxisLimits& limits) {
  const AxisState motor_state = plan_.at(now);
  // How far the load is ahead of the motor: 0 when it was pushed to the right last, the backlash when to the left.
  const double lead = load_ - motor();
  const double load = motor_state.position + origin_ + lead;
  const double rest =
      load + motor_state.speed * std::abs(motor_state.speed) / (2 * std::max(limits.acceleration, 1e-9));

  // The motor's own range: as far as the load's limits on either side of the play.
  motion::AxisLimits range = limits;
  range.from -= origin_ + geometry_.backlash;
  range.to -= origin_;
  range.speed = std::min(limits.speed, geometry_.step / motion::seconds(geometry_.least_interval));
  AxisCommand order;
  if (const auto target = target_of(command, rest, limits); target && limits.from < limits.to) {
    const double towards = *target - rest;
    const double engaged = std::abs(towards) <= kTie * geometry_.step ? lead
                           : towards > 0                              ? 0
                                                                      : geometry_.backlash;
    motion::AxisLimits shifted = limits;
    shifted.from -= origin_ + engaged;
    shifted.to -= origin_ + engaged;
    order = {AxisCommand::Kind::position, whole_steps(*target - origin_ - engaged, geometry_.step, shifted),
             speed_of(command, limits)};
  }
  plan_ = motion::Plan::make(now, motor_state, order, range, geometry_.step);
  find(now);
}

// The first step from `from` on.
void StepSchedule::find(Time from) {
  direction_ = 0;
  next_ = motion::kNever;
  for (Time t = from;;) {
    const AxisState s = plan_.at(t);
    const Time end = plan_.piece_end(t);
    const double here =
        s.position / geometry_.step - static_cast<double>(count_);  // steps ahead of the motor
    if (!s.moving()) {
      if (std::abs(here) > 0.5 + kTie) {
        direction_ = here > 0 ? 1 : -1;
        next_ = t;
        return;
      }
      if (end == motion::kNever) return;
      t = end;
      continue;
    }
    const int sign = s.speed != 0 ? (s.speed > 0 ? 1 : -1) : (s.acceleration > 0 ? 1 : -1);
    const double way = (0.5 - sign * here) * geometry_.step;
    double dt = 0;
    if (way > 0) {
      const double speed = std::abs(s.speed), inside = speed * speed + 2 * sign * s.acceleration * way;
      dt = inside >= 0 && speed + std::sqrt(inside) > 0 ? 2 * way / (speed + std::sqrt(inside)) : HUGE_VAL;
    }
    if (dt < 1e9 && (end == motion::kNever || t + Time(std::llround(dt * 1e9)) <= end)) {
      direction_ = sign;
      next_ = t + Time(std::llround(dt * 1e9));
      return;
    }
    if (end == motion::kNever) return;
    t = end;
  }
}

Time StepSchedule::next() const {
  return next_ == motion::kNever ? next_ : std::max(next_, executed_ + geometry_.least_interval);
}

void StepSchedule::advance(Time now) {
  if (direction_ == 0) return;
  count_ += direction_;
  executed_ = now;
  load_ = std::clamp(load_, motor(), motor() + geometry_.backlash);
  find(next_);
}

}  // namespace cerberus::drivers
