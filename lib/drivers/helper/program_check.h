// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether a program could be run, before it is: for the check of a configuration. Both run something for a moment, and
// nothing that moves.
#pragma once

#include <string>
#include <vector>

namespace cerberus::drivers {

// Runs `arguments` with its input closed, and returns the first line that it prints, without its end; empty: it prints
// none, cannot be run, or has not ended within 3 s.
std::string first_line_of(const std::vector<std::string>& arguments);

// What is wrong with a command of /bin/sh, for a user; empty: nothing, or the shell alone can tell. It is wrong where it is
// empty, and where the shell finds no program of its first word.
std::string command_fault(const std::string& command);

}  // namespace cerberus::drivers
