// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace cerberus::vision {

// std::lround of what an int holds, without a call.
inline int round_to_int(double value) {
  const int whole = static_cast<int>(value);
  const double rest = value - whole;  // exact
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

}  // namespace cerberus::vision
