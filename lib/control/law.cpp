// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/law.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::control {

namespace {

// A position within this distance counts as reached.
constexpr double kThere = sensing::radians(0.05);

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
  pan_.reset();
  tilt_.reset();
  left_.reset();
  way_round_.end();
  sweeping_right_ = false;
}

Command Law::track(vision::Point target, const vision::Lens& lens, const Moment& moment) {
  const motion::Pose &capture = moment.capture, &ahead = moment.ahead;
  const vision::Direction seen = lens.direction(target, capture.pan.position, capture.tilt.position);
  const bool placed = std::isfinite(ahead.pan.position) && std::isfinite(ahead.tilt.position);
  if (!std::isfinite(seen.bearing) || !std::isfinite(seen.elevation) || !placed) return {};
  const FollowedAxis::Parameters parameters{options_.response, options_.gain, options_.dead_band_start,
                                            options_.dead_band_stop, moment.view};
  Command command;
  command.state = State::tracking;
  const motion::AxisLimits &limits = options_.limits.pan, &tilt_limits = options_.limits.tilt;
  const double straight = capture.pan.position + sensing::wrap(seen.bearing - capture.pan.position);
  if (!way_round_.leaves_behind(straight, limits)) way_round_.end();  // met on the other side
  FollowedAxis::Aim pan = pan_.observe(straight, moment.base, moment.times, parameters);
  FollowedAxis::Aim tilt = tilt_.observe(seen.elevation, {}, moment.times, parameters);
  left_ = {pan.position + pan.rate * moment.times.horizon(), moment.times.taken};
  command.target = {pan.position, pan.rate};
  if (!limits.holds(pan.position)) {
    if (goes_round(pan, moment)) {
      command = *go_on_round(moment);
      command.target = {pan.position, pan.rate};
      return command;
    }
    pan.move_to(limits.clamp(pan.position));
    command.limited = true;
  }
  if (!tilt_limits.holds(tilt.position)) {
    const double stop = tilt_limits.clamp(tilt.position);
    command.limited = command.limited || std::abs(stop - tilt.position) > options_.dead_band_start;
    tilt.move_to(stop);
  }
  command.pan = pan_.command(pan, ahead.pan, limits, moment.times, parameters);
  command.tilt = tilt_.command(tilt, ahead.tilt, tilt_limits, moment.times, parameters);
  return command;
}

bool Law::goes_round(const FollowedAxis::Aim& pan, const Moment& moment) {
  return way_round_.decide({.target = pan.position,
                            .rate = pan.rate,
                            .head = moment.ahead.pan.position,
                            .view = moment.view,
                            .effect = moment.times.effect,
                            .dead_time = moment.dead_time},
                           options_.limits.pan);
}

// Nothing: the head does not go round, or it did and met no target.
std::optional<Command> Law::go_on_round(const Moment& moment) {
  const auto pan = way_round_.command(moment.times.effect, moment.ahead.pan.position, options_.limits.pan);
  if (!pan) return std::nullopt;
  Command command;
  command.pan = *pan;
  command.state = State::turning;
  command.round = true;
  return command;
}

Command Law::turn(double direction, const motion::Pose& ahead) const {
  Command command;
  command.state = State::turning;
  const motion::AxisLimits& pan = options_.limits.pan;
  command.pan = {motion::AxisCommand::Kind::velocity, direction * pan.speed, 0};
  command.limited =
      direction > 0 ? ahead.pan.position >= pan.to - kThere : ahead.pan.position <= pan.from + kThere;
  return command;
}

Command Law::search(const sensing::Interval& sector, const Moment& moment) {
  if (!std::isfinite(sector.from) || !std::isfinite(sector.to)) return {};
  Command command;
  command.state = State::searching;
  const motion::AxisLimits& pan = options_.limits.pan;
  const double from = pan.clamp(std::min(sector.from, sector.to));
  const double to = pan.clamp(std::max(sector.from, sector.to));
  command.limited = from != std::min(sector.from, sector.to) || to != std::max(sector.from, sector.to);
  const double position = moment.ahead.pan.position;
  // A person who left longer ago may be anywhere.
  if (left_ && moment.times.taken - left_->time > WayRound::Parameters{}.longest) left_.reset();
  if (last_ != fusion::Action::search)  // where the target left, else the nearer edge first
    sweeping_right_ = left_ ? left_->pan > position : to - position < position - from;
  left_.reset();
  if (position >= to - kThere) sweeping_right_ = false;
  if (position <= from + kThere) sweeping_right_ = true;
  const bool outside = position < from || position > to;
  command.pan = go(sweeping_right_ ? to : from, outside ? pan.speed : options_.turn_speed);
  return command;
}

Command Law::zero() {
  Command command;
  command.state = State::zeroing;
  command.pan = command.tilt = go(0, options_.turn_speed);
  return command;
}

Command Law::update(const Goal& goal, const vision::Lens& lens, const Moment& moment) {
  using fusion::Action;
  Command command;
  if (goal.immediate) way_round_.end();
  if (goal.action == Action::track && goal.target) {
    const bool other = std::exchange(track_, goal.track) != goal.track;
    if (other) {  // its motion is not that of the last one
      pan_.reset();
      tilt_.reset();
    }
    if (other || last_ != Action::track) {
      pan_.begin();
      tilt_.begin();
    }
    command = track(*goal.target, lens, moment);
  } else if (const auto round = go_on_round(moment)) {
    last_ = Action::hold;  // the goal begins when the turn is over
    return *round;
  } else if (goal.action == Action::turn_left || goal.action == Action::turn_right) {
    command = turn(goal.action == Action::turn_right ? 1 : -1, moment.ahead);
  } else if (goal.action == Action::search) {
    command = search(goal.sector, moment);
  } else if (goal.action == Action::zero) {
    command = zero();
  }
  last_ = command.state == State::holding ? Action::hold : goal.action;
  return command;
}

}  // namespace cerberus::control
