// SPDX-License-Identifier: LGPL-2.1-or-later
// Bounds of wall-clock time hold on a machine that does nothing else: they are checked on request.
#pragma once

#include <chrono>
#include <cstdlib>

namespace cerberus::tests {

// How long a test waits for what must come at last, whatever else the machine does.
inline constexpr std::chrono::seconds kPatience{60};

// Whether what took this long is quick enough. Without CERBERUS_KILLS in the environment everything is.
inline bool in_time(std::chrono::steady_clock::duration took, std::chrono::steady_clock::duration most) {
  return took < most || !std::getenv("CERBERUS_KILLS");
}

}  // namespace cerberus::tests
