// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/base_request.h"

#include <algorithm>
#include <cmath>

namespace cerberus::control {

double BaseRequest::update(double target, double rate, const motion::AxisLimits& limits, double most) {
  const Parameters p;
  const double place = target + rate * p.ahead;
  if (!(most > 0) || !std::isfinite(place))
    side_ = 0;
  else if (side_ == 0 && place > limits.to - std::min(p.near, limits.to / 4))
    side_ = 1;
  else if (side_ == 0 && place < limits.from + std::min(p.near, -limits.from / 4))
    side_ = -1;
  if (side_ == 0) return 0;
  const double stop = side_ > 0 ? limits.to : -limits.from;
  const double excess = side_ * place - (stop - std::min(p.room, stop / 2));
  const double wanted = std::min(most, p.gain * excess);
  if (wanted < p.least) side_ = 0;
  return side_ * wanted;
}

}  // namespace cerberus::control
