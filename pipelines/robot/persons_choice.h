// SPDX-License-Identifier: LGPL-2.1-or-later
// Which cameras look for people by their shape where the configuration leaves it open.
#pragma once

#include "robot/settings.h"

namespace cerberus::robot {

// Puts PersonsUse::always or never in place of automatic, and prints why a camera goes without.
void choose_persons(Settings& settings);

}  // namespace cerberus::robot
