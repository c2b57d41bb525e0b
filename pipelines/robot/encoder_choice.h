// SPDX-License-Identifier: LGPL-2.1-or-later
// Which encoder of H.264 this machine has, for `encoder = "h264"`.
#pragma once

#include "robot/settings.h"

namespace cerberus::robot {

// Puts an element in place of "h264": the first in the order of publish::encoders() that is installed, of hardware one
// that encodes some frames. It is tried once in the life of the process.
void choose_encoders(Settings& settings);

}  // namespace cerberus::robot
