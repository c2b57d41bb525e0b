// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/limits.h"

namespace cerberus::vision {

SizeLimits human_size() {
  SizeLimits gate;
  gate.metres_wide = {0.5 * kBodyWidth, 3 * kBodyWidth};
  return gate;
}

SpeedLimits human_speed() {
  SpeedLimits gate;
  gate.metres = {0.1, 4.0};
  return gate;
}

bool passes(const SizeLimits& gate, const Box& box, const Placement& place) {
  return gate.width.holds(box.width) && gate.height.holds(box.height) &&
         gate.metres_wide.holds(place.width) && gate.metres_high.holds(place.height);
}

bool passes(const SpeedLimits& gate, double speed, double top_speed, const Placement& place) {
  const auto within = [&](const Range& range, double now, double top) {
    return !(range.most > 0 && now > range.most) && !(top < range.least);
  };
  return within(gate.pixels, speed, top_speed) &&
         within(gate.metres, to_metres(speed, place), to_metres(top_speed, place));
}

}  // namespace cerberus::vision
