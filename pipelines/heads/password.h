// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a camera's password comes from. It is never an argument: every user of the machine can read those.
#pragma once

#include <string>

namespace cerberus::heads {

struct PasswordSource {
  std::string file;         // its first line
  std::string environment;  // a variable's name
  std::string credential;   // a credential of systemd (LoadCredential=): a file in $CREDENTIALS_DIRECTORY
};

// Returns what is wrong, without the password; empty: `password` is set (to nothing where no source is given).
std::string read_password(const PasswordSource& source, std::string& password);

}  // namespace cerberus::heads
