// SPDX-License-Identifier: LGPL-2.1-or-later
// Ensures that one program of this machine drives a head: HeadLease does so within a process.
#pragma once

#include <chrono>
#include <string>

namespace cerberus::heads {

// Holds the place (drivers/head/head_place.h) until this process ends, however it ends: as a name in the kernel's
// abstract socket namespace (unix(7)), which no file survives and which ends at the border of a network namespace.
// A place that is held is waited for: the helper of a pipeline that has just ended may still be stopping its head.
// Returns what is wrong; then nothing is held. An empty place is nobody's.
std::string hold_place(const std::string& place, std::chrono::milliseconds patience);

}  // namespace cerberus::heads
