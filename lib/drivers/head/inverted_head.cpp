// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/head/inverted_head.h"

namespace cerberus::drivers {
namespace {

// Not -value: a line would say -0.
double negative(double value) {
  return 0.0 - value;
}

void negate(motion::AxisLimits& axis) {
  const double from = axis.from;
  axis.from = negative(axis.to);
  axis.to = negative(from);
}

void negate(motion::AxisState& axis) {
  axis.position = negative(axis.position);
  axis.speed = negative(axis.speed);
  axis.acceleration = negative(axis.acceleration);
}

// The speed of a position command has no sign.
motion::AxisCommand negated(motion::AxisCommand command) {
  command.value = negative(command.value);
  return command;
}

}  // namespace

std::string parse_inverted(const OptionWord& word, Inverted& inverted) {
  Inverted read{!word.has_value, !word.has_value};
  for (const std::string& axis : word.has_value ? split(word.value, ',') : std::vector<std::string>()) {
    if (axis != "pan" && axis != "tilt")
      return "invert=" + word.value + ": write invert=pan, invert=tilt, or invert for both axes";
    (axis == "pan" ? read.pan : read.tilt) = true;
  }
  inverted = {inverted.pan || read.pan, inverted.tilt || read.tilt};
  return {};
}

motion::Limits InvertedHead::negated(motion::Limits limits) const {
  if (inverted_.pan) negate(limits.pan);
  if (inverted_.tilt) negate(limits.tilt);
  return limits;
}

motion::PanTilt InvertedHead::negated(const motion::PanTilt& at) const {
  return {inverted_.pan ? negative(at.pan) : at.pan, inverted_.tilt ? negative(at.tilt) : at.tilt};
}

std::string InvertedHead::open(const HeadSetup& setup, Time now) {
  HeadSetup turned = setup;
  turned.limits = negated(setup.limits);
  const motion::PanTilt start = negated(motion::PanTilt{setup.pan, setup.tilt});
  turned.pan = start.pan;
  turned.tilt = start.tilt;
  return device_.open(turned, now);
}

void InvertedHead::move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) {
  device_.move(inverted_.pan ? drivers::negated(pan) : pan, inverted_.tilt ? drivers::negated(tilt) : tilt,
               now);
}

void InvertedHead::limit(const motion::Limits& limits, Time now) {
  device_.limit(negated(limits), now);
}

std::optional<PoseLine> InvertedHead::take_pose(Time now) {
  std::optional<PoseLine> pose = device_.take_pose(now);
  if (pose && inverted_.pan) negate(pose->pan);
  if (pose && inverted_.tilt) negate(pose->tilt);
  return pose;
}

std::optional<SpeedsLine> InvertedHead::take_speeds(Time now) {
  std::optional<SpeedsLine> speeds = device_.take_speeds(now);
  if (speeds) speeds->speed = negated(speeds->speed);
  return speeds;
}

std::optional<HomedLine> InvertedHead::take_homed(Time now) {
  std::optional<HomedLine> homed = device_.take_homed(now);
  if (homed) homed->at = negated(homed->at);
  return homed;
}

}  // namespace cerberus::drivers
