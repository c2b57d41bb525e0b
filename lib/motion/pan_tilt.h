// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace cerberus::motion {

// A direction of the head, radians: pan positive to the right, tilt positive up.
struct PanTilt {
  double pan = 0, tilt = 0;
};

}  // namespace cerberus::motion
