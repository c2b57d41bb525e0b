// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the users of the server are listed. Passwords are never arguments: every user of the machine can read those.
#pragma once

#include <string>
#include <vector>

#include "publish/streams/users.h"

namespace cerberus::rtsp {

struct UserSource {
  std::string file;         // that has the lines of publish::parse_users
  std::string environment;  // the variable that has them
  std::string credential;   // a credential of systemd (LoadCredential=): a file in $CREDENTIALS_DIRECTORY
};

// Returns what is wrong, without any password; empty: `users` is set (to nothing where no source is given).
std::string read_users(const UserSource& source, std::vector<publish::User>& users);

}  // namespace cerberus::rtsp
