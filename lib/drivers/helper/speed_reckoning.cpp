// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/speed_reckoning.h"

#include <algorithm>
#include <cmath>

#include "motion/stop_margin.h"

namespace cerberus::drivers {

void SpeedReckoning::begin(Time now, const motion::PanTilt& at) {
  reckoned_.begin(now, at);
  in_force_ = before_ = {};
  unstopped_.reset();
  changed_ = 0;
}

void SpeedReckoning::turn(const motion::PanTilt& speed, Time time) {
  const motion::PanTilt last = reckoned_.last();
  if (speed.pan == last.pan && speed.tilt == last.tilt) return;
  reckoned_.turn(time, speed);
  if (changed_ == changes_.size()) --changed_;  // the newest counts most
  changes_[changed_++] = {speed, time};
}

void SpeedReckoning::set_speeds(const motion::PanTilt& speed, Time now, Time until) {
  before_ = in_force_;
  in_force_ = {speed, now, until};
  unstopped_.reset();
  turn(speed, now);
}

void SpeedReckoning::on_refused() {
  if (unstopped_) {
    unstopped_ = before_;
    return;
  }
  turn(before_.speed, in_force_.from);
  in_force_ = before_;
}

void SpeedReckoning::stop(Time now) {
  if (!unstopped_) {
    unstopped_ = in_force_;
    stopped_ = now;
  }
  in_force_ = {.from = now};
  turn({}, now);
}

Time SpeedReckoning::end_of_lost() const {
  constexpr Parameters kParameters;
  if (unstopped_->until != motion::kNever) return unstopped_->until;
  return stopped_ + Time(static_cast<Time::rep>(kParameters.most_lost * 1e9));
}

void SpeedReckoning::on_stopped(Time sent) {
  if (!unstopped_) return;
  const Time end = std::min(sent, end_of_lost());
  if (end > stopped_) {
    turn(unstopped_->speed, stopped_);
    turn({}, end);
  }
  unstopped_.reset();
}

void SpeedReckoning::on_stop_lost() {
  if (!unstopped_) return;
  in_force_ = *unstopped_;
  in_force_.until = end_of_lost();
  unstopped_.reset();
  turn(in_force_.speed, stopped_);
}

void SpeedReckoning::expire(Time now) {
  if (now < in_force_.until) return;
  turn({}, in_force_.until);
  in_force_ = {.from = in_force_.until};
}

motion::PanTilt SpeedReckoning::position(Time now) const {
  const motion::Pose here = reckoned_.at(now);
  return {here.pan.position, here.tilt.position};
}

void SpeedReckoning::report_again(Time now) {
  changes_.front() = {reckoned_.last(), now};
  changed_ = 1;
}

std::optional<SpeedsLine> SpeedReckoning::take_speeds(Time now) {
  if (changed_ == 0) return std::nullopt;
  const Change oldest = changes_.front();
  std::move(changes_.begin() + 1, changes_.begin() + changed_--, changes_.begin());
  return SpeedsLine{oldest.speed, motion::seconds(now - oldest.time)};
}

motion::PanTilt SpeedReckoning::confined(const motion::PanTilt& speed, const motion::PanTilt& measured,
                                         const motion::Limits& limits, double reaction, Time now) const {
  constexpr Parameters kParameters;
  const auto axis = [&](double v, double position, double reckoned, const motion::AxisLimits& within) {
    double margin = motion::stop_margin(std::abs(v), reaction, 0, within.to - within.from);
    if (std::isnan(position)) {
      position = reckoned;
      margin = -kParameters.slack;
    }
    const bool beyond = v > 0 ? position >= within.to - margin : position <= within.from + margin;
    return beyond ? 0 : v;
  };
  const motion::PanTilt here = position(now);
  return {axis(speed.pan, measured.pan, here.pan, limits.pan),
          axis(speed.tilt, measured.tilt, here.tilt, limits.tilt)};
}

}  // namespace cerberus::drivers
