// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/speed_reckoning.h"

#include <cmath>
#include <utility>

#include "motion/stop_margin.h"

namespace cerberus::drivers {

void SpeedReckoning::set_speeds(const motion::PanTilt& speed, Time now) {
  const motion::PanTilt last = reckoned_.last();
  if (speed.pan == last.pan && speed.tilt == last.tilt) return;
  reckoned_.turn(now, speed);
  changed_ = now;
}

std::optional<SpeedsLine> SpeedReckoning::take_speeds(Time now) {
  const auto changed = std::exchange(changed_, std::nullopt);
  if (!changed) return std::nullopt;
  return SpeedsLine{reckoned_.last(), motion::seconds(now - *changed)};
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
  const motion::Pose here = reckoned_.at(now);
  return {axis(speed.pan, measured.pan, here.pan.position, limits.pan),
          axis(speed.tilt, measured.tilt, here.tilt.position, limits.tilt)};
}

}  // namespace cerberus::drivers
