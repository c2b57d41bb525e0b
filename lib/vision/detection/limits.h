// SPDX-License-Identifier: LGPL-2.1-or-later
// Limits of size and speed of the objects to report, in pixels and, where lens and mounting height give the distance, in
// metres. Pure functions of the measurements.
#pragma once

#include "vision/geometry/lens.h"

namespace cerberus::vision {

// From `least` to `most`, both included; most 0 = no upper limit.
struct Range {
  double least = 0;
  double most = 0;
  // An unknown value (NaN) passes: what cannot be measured cannot be refused.
  bool holds(double value) const { return !(value < least) && !(most > 0 && value > most); }
};

struct SizeLimits {
  Range width{}, height{};             // frame pixels
  Range metres_wide{}, metres_high{};  // judged only where the object's distance is known
};

struct SpeedLimits {
  Range pixels{};  // a second
  Range metres{};  // a second, judged only where the object's distance is known
};

// The paper's limits for humans (III): bodies 48 cm wide at 0.1 to 4 m/s. Boxes from half the width (seen from the
// side, partly hidden) to three times the width (a stride with swinging arms, two persons arm in arm) pass.
constexpr double kBodyWidth = 0.48;
SizeLimits human_size();
SpeedLimits human_speed();

bool passes(const SizeLimits& gate, const Box& box, const Placement& place);

// speed: now; top_speed: the highest the object has shown (smoothed), both frame pixels a second. The upper
// limit is compared with the speed now, the lower limit with the highest: a person who came walking and stands
// passes, a swaying bush does not.
bool passes(const SpeedLimits& gate, double speed, double top_speed, const Placement& place);

// Of lengths and speeds across the line of sight.
inline double to_metres(double pixels, const Placement& place) {
  return pixels * place.metres_per_pixel;
}

}  // namespace cerberus::vision
