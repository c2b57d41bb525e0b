// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <string>

namespace cerberus::plugin {

// The path of cerberus-head, which drives real heads: what the environment's CERBERUS_HEAD names, else the one of the
// build folder in which this module lies, else the installed one.
std::string helper_program();

}  // namespace cerberus::plugin
