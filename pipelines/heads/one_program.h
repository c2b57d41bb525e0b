// SPDX-License-Identifier: LGPL-2.1-or-later
// Ensures that one program of this machine drives a head: HeadLease does so within a process.
#pragma once

#include <chrono>
#include <string>

namespace cerberus::heads {

// Holds the place (drivers/head/head_place.h) until this process ends, however it ends: as a name in the kernel's
// abstract socket namespace (unix(7)), which no file survives and which ends at the border of a network namespace.
// A place that is given up, or whose program has ended, is waited for: that program's helper still stops its head. Another
// one is not, but for kMoment, in which a program may notice its end.
// Returns what is wrong; then nothing is held. An empty place is nobody's.
std::string hold_place(const std::string& place, std::chrono::milliseconds patience);
inline constexpr std::chrono::milliseconds kMoment{300};

// The place that this process holds is soon free: its pipeline has ended.
void give_up_place();

}  // namespace cerberus::heads
