// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/law.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::control {

namespace {

// A position within this distance counts as reached.
constexpr double kThere = sensing::radians(0.05);
// A target beyond a stop is watched from that stop until it is this far beyond it. Only then does the head turn all the
// way round, if the target is reachable from the other side: the turn takes seconds, and a target near the edge would
// cause it repeatedly.
constexpr double kGoRound = sensing::radians(10);

double positive(double value, double otherwise) {
  return value > 0 && std::isfinite(value) ? value : otherwise;
}

motion::AxisCommand go(double position, double speed) {
  return {motion::AxisCommand::Kind::position, position, speed};
}

}  // namespace

void Law::set_options(const LawOptions& options) {
  options_ = options;
  const LawOptions standard;
  options_.turn_speed = positive(options.turn_speed, standard.turn_speed);
  options_.gain = positive(options.gain, standard.gain);
  options_.dead_band_stop = options.dead_band_stop >= 0 ? options.dead_band_stop : standard.dead_band_stop;
  options_.dead_band_start = std::max(options_.dead_band_stop, options.dead_band_start);  // the first, if NaN
}

void Law::reset() {
  last_ = fusion::Action::hold;
  pan_moving_ = tilt_moving_ = sweeping_right_ = false;
}

motion::AxisCommand Law::approach(double target, double position, bool& moving) const {
  const double error = std::abs(target - position);
  moving = error > (moving ? options_.dead_band_stop : options_.dead_band_start);
  return moving ? go(target, options_.gain * error) : motion::AxisCommand{};
}

Command Law::track(vision::Point target, const vision::Lens& lens, const motion::Pose& capture,
                   const motion::Pose& ahead) {
  const vision::Direction seen = lens.direction(target, capture.pan.position, capture.tilt.position);
  if (!std::isfinite(seen.bearing) || !std::isfinite(seen.elevation)) return {};
  Command command;
  command.state = State::tracking;
  const motion::AxisLimits& pan = options_.limits.pan;
  const double straight = capture.pan.position + sensing::wrap(seen.bearing - capture.pan.position);
  double bearing = straight;
  if (!pan.holds(straight)) {
    const double stop = pan.clamp(straight);
    const motion::Reach round = reach(seen.bearing, stop, pan);
    const bool worth = !round.limited && std::abs(straight - stop) > kGoRound;
    bearing = worth ? round.position : stop;
    command.limited = !worth;
  }
  const double height = options_.limits.tilt.clamp(seen.elevation);
  command.limited = command.limited || std::abs(height - seen.elevation) > options_.dead_band_start;
  command.pan = approach(bearing, ahead.pan.position, pan_moving_);
  command.tilt = approach(height, ahead.tilt.position, tilt_moving_);
  return command;
}

Command Law::turn(double direction, const motion::Pose& ahead) const {
  Command command;
  command.state = State::turning;
  command.pan = {motion::AxisCommand::Kind::velocity, direction * options_.turn_speed, 0};
  const motion::AxisLimits& pan = options_.limits.pan;
  command.limited =
      direction > 0 ? ahead.pan.position >= pan.to - kThere : ahead.pan.position <= pan.from + kThere;
  return command;
}

Command Law::search(const sensing::Interval& sector, const motion::Pose& ahead) {
  if (!std::isfinite(sector.from) || !std::isfinite(sector.to)) return {};
  Command command;
  command.state = State::searching;
  const motion::AxisLimits& pan = options_.limits.pan;
  const double from = pan.clamp(std::min(sector.from, sector.to));
  const double to = pan.clamp(std::max(sector.from, sector.to));
  command.limited = from != std::min(sector.from, sector.to) || to != std::max(sector.from, sector.to);
  const double position = ahead.pan.position;
  if (last_ != fusion::Action::search)
    sweeping_right_ = to - position < position - from;  // the nearer edge first
  if (position >= to - kThere) sweeping_right_ = false;
  if (position <= from + kThere) sweeping_right_ = true;
  command.pan = go(sweeping_right_ ? to : from, options_.turn_speed);
  return command;
}

Command Law::zero() const {
  Command command;
  command.state = State::zeroing;
  command.pan = command.tilt = go(0, options_.turn_speed);
  return command;
}

Command Law::update(const Goal& goal, const vision::Lens& lens, const motion::Pose& capture,
                    const motion::Pose& ahead) {
  using fusion::Action;
  Command command;
  if (goal.action == Action::track && goal.target) {
    if (last_ != Action::track)
      pan_moving_ = tilt_moving_ =
          true;  // a new target is centred: the start of the dead band does not apply
    command = track(*goal.target, lens, capture, ahead);
  } else if (goal.action == Action::turn_left || goal.action == Action::turn_right) {
    command = turn(goal.action == Action::turn_right ? 1 : -1, ahead);
  } else if (goal.action == Action::search) {
    command = search(goal.sector, ahead);
  } else if (goal.action == Action::zero) {
    command = zero();
  }
  last_ = command.state == State::holding ? Action::hold : goal.action;
  return command;
}

}  // namespace cerberus::control
