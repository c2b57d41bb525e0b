// SPDX-License-Identifier: LGPL-2.1-or-later
// A device for one program, and the program that has it.
#pragma once

#include <string>

namespace cerberus::drivers {

// Takes the open device for this program (flock(2)), until the descriptor is closed, however the program ends. Programs that
// look at no lock are not kept away. Returns EBUSY where another program has it so; else 0.
int lock_device(int fd) noexcept;

// "another program" that has the device open, with its number and name where these can be read: "another program (process
// 1234, minicom)". One that has locked it comes first.
std::string program_with(const std::string& path);

}  // namespace cerberus::drivers
