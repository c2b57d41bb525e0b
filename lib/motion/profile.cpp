// SPDX-License-Identifier: LGPL-2.1-or-later
#include "motion/profile.h"

#include <algorithm>
#include <cmath>

namespace cerberus::motion {

namespace {

// Seconds: shorter pieces are dropped, since times have a resolution of a nanosecond.
constexpr double kInstant = 1e-9;

// Returns the multiple of `step` nearest to `position`; with a direction, the nearest one that does not lie before
// `position` in that direction.
double on_grid(double position, double step, double direction, const AxisLimits& limits) {
  if (!(step > 0)) return position;
  const double count = position / step;
  constexpr double kTie = 1e-6;  // of a step
  double steps = direction > 0   ? std::ceil(count - kTie)
                 : direction < 0 ? std::floor(count + kTie)
                                 : std::round(count);
  if (steps * step > limits.to) steps = std::floor(limits.to / step);
  if (steps * step < limits.from) steps = std::ceil(limits.from / step);
  return limits.holds(steps * step) ? steps * step : limits.clamp(position);
}

}  // namespace

void Plan::add(double length, double acceleration, double& position, double& speed) {
  if (!(length > kInstant)) return;
  Piece piece;
  if (count_ > 0)
    piece.seconds = pieces_[static_cast<unsigned>(count_ - 1)].seconds +
                    pieces_[static_cast<unsigned>(count_ - 1)].length;
  piece.length = length;
  piece.position = position;
  piece.speed = speed;
  piece.acceleration = acceleration;
  pieces_[static_cast<unsigned>(count_++)] = piece;
  position += (speed + 0.5 * acceleration * length) * length;
  speed += acceleration * length;
}

// From (x, v) to rest at X under |v| <= V and |acceleration| <= a. With s = sign of the way that is left after braking
// at once (X - x - v|v| / 2a), D = s (X - x) and u = s v, the peak w of the trapezoid is
//   w = min(V, sqrt(a D + u^2 / 2)),   accelerate (w - u) / a,  cruise (D - (2 w^2 - u^2) / 2a) / w,  brake w / a
// and where u > V the first piece brakes to V.
void Plan::travel(double position, double speed, double target, double most, double acceleration) {
  const double rest = position + speed * std::abs(speed) / (2 * acceleration);
  const double s = target >= rest ? 1 : -1;
  const double distance = s * (target - position), u = s * speed;
  if (u > most) {
    add((u - most) / acceleration, -s * acceleration, position, speed);
    const double brake = (u * u) / (2 * acceleration);
    add((distance - brake) / most, 0, position, speed);
    add(most / acceleration, -s * acceleration, position, speed);
    return;
  }
  const double peak = std::min(most, std::sqrt(std::max(0.0, acceleration * distance + u * u / 2)));
  if (u <
      0) {  // split at the reversal: the speed of a piece keeps its sign, so that backlash needs the ends only
    add(-u / acceleration, s * acceleration, position, speed);
    speed = 0;
  }
  add((peak - std::max(0.0, u)) / acceleration, s * acceleration, position, speed);
  if (peak > 0) add((distance - (2 * peak * peak - u * u) / (2 * acceleration)) / peak, 0, position, speed);
  add(peak / acceleration, -s * acceleration, position, speed);
}

Plan Plan::make(Time start, const AxisState& state, const AxisCommand& command, const AxisLimits& limits,
                double step) {
  double position = std::isfinite(state.position) ? state.position : limits.clamp(state.position);
  double speed = std::isfinite(state.speed) ? state.speed : 0;
  Plan plan(position, start);
  plan.low_ = std::min(limits.from, position);
  plan.high_ = std::max(limits.to, position);

  // Brake harder than permitted if there is not enough room before the stop.
  const double room = speed > 0 ? limits.to - position : position - limits.from;
  if (speed != 0 && !(room > 0)) speed = 0;
  if (speed != 0 && speed * speed > 2 * limits.acceleration * room * (1 + 1e-9)) {
    const double harder = speed * speed / (2 * room);
    const double stop = speed > 0 ? limits.to : limits.from;
    plan.add(std::abs(speed) / harder, speed > 0 ? -harder : harder, position, speed);
    position = stop;
    speed = 0;
  }

  double target = position + speed * std::abs(speed) / (2 * limits.acceleration);
  double direction =
      speed;  // rounds the target forward, because a grid point behind it would reverse the axis
  double most = limits.speed;
  const bool sane = std::isfinite(command.value) && std::isfinite(command.speed);
  if (command.kind == AxisCommand::Kind::position && sane && command.speed > 0) {
    target = command.value;
    direction = 0;
    most = std::min(most, command.speed);
  } else if (command.kind == AxisCommand::Kind::velocity && sane && command.value != 0) {
    target = command.value > 0 ? limits.to : limits.from;
    direction = 0;
    most = std::min(most, std::abs(command.value));
  }
  plan.target_ = on_grid(limits.clamp(target), step, direction, limits);
  if (limits.from < limits.to) plan.travel(position, speed, plan.target_, most, limits.acceleration);
  return plan;
}

void Plan::shift(double way) {
  for (double* position : {&target_, &low_, &high_}) *position += way;
  for (Piece& piece : pieces_) piece.position += way;
}

Time Plan::time_of(double seconds) const {
  return start_ + Time(static_cast<Time::rep>(std::ceil(seconds * 1e9)));
}

Time Plan::end() const {
  if (count_ == 0) return start_;
  const Piece& last = pieces_[static_cast<unsigned>(count_ - 1)];
  return time_of(last.seconds + last.length);
}

AxisState Plan::at(Time time) const {
  if (count_ == 0 || time >= end()) return {target_, 0, 0};
  const double elapsed = std::max(0.0, motion::seconds(time - start_));
  int k = count_ - 1;
  while (k > 0 && pieces_[static_cast<unsigned>(k)].seconds > elapsed) --k;
  const Piece& piece = pieces_[static_cast<unsigned>(k)];
  if (time < start_) return {piece.position, 0, 0};
  const double dt = std::min(elapsed - piece.seconds, piece.length);
  const double position = piece.position + (piece.speed + 0.5 * piece.acceleration * dt) * dt;
  return {std::clamp(position, low_, high_),  // rounding must not lead beyond a stop
          piece.speed + piece.acceleration * dt, piece.acceleration};
}

Time Plan::piece_end(Time time) const {
  if (time < start_ && count_ > 0) return start_;
  for (int k = 0; k < count_; ++k) {
    const Piece& piece = pieces_[static_cast<unsigned>(k)];
    const Time end = time_of(piece.seconds + piece.length);
    if (time < end) return end;
  }
  return kNever;
}

}  // namespace cerberus::motion
