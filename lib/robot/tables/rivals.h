// SPDX-License-Identifier: LGPL-2.1-or-later
// Two parts of a configuration that want what only one can have: a port, a head, a camera, a GPIO line, a serial port.
#pragma once

#include "robot/settings.h"
#include "robot/tables/table_reader.h"

namespace cerberus::robot {

void find_rivals(const Settings& settings, Mistakes& mistakes);

}  // namespace cerberus::robot
