// SPDX-License-Identifier: LGPL-2.1-or-later
// The file of the devices that the page lets in without a password.
#pragma once

#include <string>

#include "robot/page/devices.h"
#include "robot/settings.h"

namespace cerberus::robot {

std::string path_of_devices(const std::string& state_folder);
// SHA-256 in hexadecimal digits.
std::string hash_of_token(const std::string& token);
// Reads the file; without one there are no devices. False: it has another content, and `error` says so.
bool load_devices(const std::string& state_folder, Devices& devices, std::string& error);

// What the command line asks for: a new device's token and address, which are printed once; the end of one; the list.
// Returns the exit status of the process.
int make_device_token(const Settings& settings, const std::string& name, const std::string& role);
int revoke_device(const Settings& settings, const std::string& name);
int list_devices(const Settings& settings);

}  // namespace cerberus::robot
