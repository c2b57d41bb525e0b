// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace cerberus::vision {

// std::lround without a call. |value| < 2^31.
inline int round_to_int(double value) {
  const int whole = static_cast<int>(value);
  const double rest = value - whole;  // exact
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

}  // namespace cerberus::vision
