// SPDX-License-Identifier: LGPL-2.1-or-later
// Passwords do not belong into the settings of a head: those are shown in graphs of the pipeline, and a helper's arguments
// in the list of processes. A setting that holds one is shown without it, and refused.
#pragma once

#include <string>

namespace cerberus::drivers {

// `device` or options of it with three asterisks in place of a password: `http://user:***@host`, `password=***`.
std::string without_password(const std::string& setting);

// Why this setting is refused, without the password; empty: it holds none.
std::string refuse_password(const std::string& setting);

}  // namespace cerberus::drivers
