// SPDX-License-Identifier: LGPL-2.1-or-later
// Which objects are worth telling: limits of size and speed, in pixels and, where lens and mounting height
// place the object, in metres. Pure functions of what was measured.
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

// The paper's human gate (III): bodies 48 cm wide at 0.1 to 4 m/s. A box is not a body: half of it is
// accepted (seen from the side, partly hidden) and three times of it (a stride with swinging arms, two arm in
// arm).
constexpr double kBodyWidth = 0.48;
SizeLimits human_size();
SpeedLimits human_speed();

bool passes(const SizeLimits& gate, const Box& box, const Placement& place);

// speed: now; top_speed: the highest the object has shown (smoothed), both frame pixels a second. The upper
// limit is for the speed now. The lower limit asks whether it has ever been that fast: somebody who came
// walking and stands is still somebody, a swaying bush never was.
bool passes(const SpeedLimits& gate, double speed, double top_speed, const Placement& place);

// Of lengths and speeds across the line of sight.
inline double to_metres(double pixels, const Placement& place) {
  return pixels * place.metres_per_pixel;
}

}  // namespace cerberus::vision
