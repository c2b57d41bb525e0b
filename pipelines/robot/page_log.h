// SPDX-License-Identifier: LGPL-2.1-or-later
// The newest lines that cerberusd wrote to standard error, for the page.
#pragma once

#include <string>

namespace cerberus::robot {

// From now on what g_printerr() prints is kept, too: the newest 300 lines.
void collect_log();
std::string collected_log();

}  // namespace cerberus::robot
