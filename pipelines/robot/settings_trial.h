// SPDX-License-Identifier: LGPL-2.1-or-later
// Tries settings before they are taken: makes of them what the start makes (pipelines with their elements' properties,
// certificates, the webhook), and starts, opens and writes nothing. Every key that could fail at the start fails here.
#pragma once

#include "robot/settings.h"
#include "robot/tables/table_reader.h"

namespace cerberus::robot {

struct Trial {
  Mistakes mistakes;  // with which a part would never start
  Mistakes lacks;     // what this machine does not have at the moment; the robot waits for it
};

Trial try_settings(const Settings& settings);

// The folder of the mode and the passwords where the file names none.
std::string default_state_folder();

}  // namespace cerberus::robot
