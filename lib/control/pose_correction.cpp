// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/pose_correction.h"

#include <algorithm>
#include <cmath>

#include "motion/stop_margin.h"

namespace cerberus::control {

using motion::AxisLimits;
using motion::Limits;
using motion::PanTilt;
using motion::Pose;

void PoseCorrection::reset(const Pose& start, Time dead_time) {
  *this = {};
  estimate_.reset({start.pan.position, start.tilt.position});
  raw_.add(start);
  dead_time_ = dead_time;
}

void PoseCorrection::add(Pose& pose) {
  raw_.add(pose);
  if (pose.measured) return;
  pose.pan.position += shift_.pan;
  pose.tilt.position += shift_.tilt;
}

// Of the larger one of all commands that are in force or on their way, radians a second.
double PoseCorrection::speed(Time taken) const {
  const auto of = [](const Pose& pose) {
    const double braking = pose.moving() ? 1e-9 : 0;  // a head that begins to move has no speed yet
    return std::max({std::abs(pose.pan.speed), std::abs(pose.tilt.speed), braking});
  };
  return std::max(of(raw_.at(taken)), of(raw_.at(taken + dead_time_)));
}

bool PoseCorrection::on_frame(Time taken, const Pose& ahead, const std::optional<Turn>& turn,
                              const Limits& limits, bool base_known) {
  const Pose raw = raw_.at(taken);
  const PanTilt here{raw.pan.position, raw.tilt.position};
  ahead_ = ahead;
  seen_.reset();
  if (raw.measured) {
    estimate_.reset(here);
    shift_ = {};
    position_.reset();
  } else {
    if (before_) {
      const PanTilt reckoned{here.pan - before_->pan, here.tilt - before_->tilt};
      seen_ = base_known ? turn : division_.head(taken, reckoned, speed(taken), turn);
      estimate_.add(reckoned, seen_);
    }
    position_ = estimate_.position();
    shift_ = {position_->pan - here.pan, position_->tilt - here.tilt};
  }
  before_ = here;
  const Limits now = this->limits(limits);
  const Limits last = sent_.value_or(limits);
  const auto moved = [](const AxisLimits& a, const AxisLimits& b) {
    return std::max(std::abs(a.from - b.from), std::abs(a.to - b.to)) > kLeastChange;
  };
  const bool changed = moved(now.pan, last.pan) || moved(now.tilt, last.tilt);
  if (changed) sent_ = now;
  return changed;
}

Limits PoseCorrection::narrowed(const Limits& limits) const {
  if (!position_) return limits;
  const auto axis = [this](AxisLimits axis, double speed) {
    const double range = axis.to - axis.from, uncertainty = estimate_.uncertainty();
    axis.from = std::min(
        0.0, axis.from + motion::stop_margin(-speed, motion::seconds(dead_time_), uncertainty, range));
    axis.to =
        std::max(0.0, axis.to - motion::stop_margin(speed, motion::seconds(dead_time_), uncertainty, range));
    return axis;
  };
  return {axis(limits.pan, ahead_.pan.speed), axis(limits.tilt, ahead_.tilt.speed)};
}

Limits PoseCorrection::limits(const Limits& limits) const {
  Limits out = narrowed(limits);
  out.pan.from -= shift_.pan;
  out.pan.to -= shift_.pan;
  out.tilt.from -= shift_.tilt;
  out.tilt.to -= shift_.tilt;
  return out;
}

void PoseCorrection::to_driver(drivers::HeadCommand& command) const {
  using Kind = motion::AxisCommand::Kind;
  if (command.pan.kind == Kind::position) command.pan.value -= shift_.pan;
  if (command.tilt.kind == Kind::position) command.tilt.value -= shift_.tilt;
}

}  // namespace cerberus::control
