// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/trials/move_check.h"

#include <algorithm>
#include <cmath>

#include "text/numbers.h"

namespace cerberus::control {
namespace {

double beyond(double position, const motion::AxisLimits& limits) {
  return std::max({0.0, limits.from - position, position - limits.to});
}

std::string in_degrees(double angle) {
  return std::isfinite(angle) ? text::rounded(sensing::degrees(angle), 1).string() : "no number";
}

}  // namespace

bool MoveCheck::add(Axis& axis, const char* name, motion::Time time, double reported, double speed,
                    const motion::AxisLimits& limits) {
  // It turns as far as the limit ahead, where its helper stops it.
  const double end = speed > 0 ? std::max(axis.start, limits.to) : std::min(axis.start, limits.from);
  const double way = speed * motion::seconds(time - *begin_);
  const bool turns = std::abs(way) < std::abs(end - axis.start);
  const double commanded = turns ? axis.start + way : speed == 0 ? axis.start : end;
  const auto verdict = axis.watch.add(time, reported, commanded, turns ? speed : 0, latency_);
  if (verdict == motion::ReportWatch::Verdict::parted && fault_.empty())
    fault_ = std::string("the head reports ") + in_degrees(reported) + " as " + name +
             ", and its speed leads to " + in_degrees(commanded) +
             " degrees: check what blocks or turns it, its limits, and the direction and unit of its reports";
  return !(beyond(reported, limits) > axis.beyond);
}

bool MoveCheck::add(motion::Time time, const motion::PanTilt& reported) {
  const auto known = [](double first) { return std::isfinite(first) ? first : 0; };
  if (!begin_) {
    begin_ = time;
    pan_.start = known(reported.pan);
    tilt_.start = known(reported.tilt);
    pan_.beyond = beyond(pan_.start, limits_.pan);
    tilt_.beyond = beyond(tilt_.start, limits_.tilt);
  }
  const bool pan = add(pan_, "pan", time, reported.pan, speed_.pan, limits_.pan);
  const bool tilt = add(tilt_, "tilt", time, reported.tilt, speed_.tilt, limits_.tilt);
  return pan && tilt && fault_.empty();
}

}  // namespace cerberus::control
