// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the users of the server are listed, in the lines of publish::parse_users.
#pragma once

#include <string>
#include <vector>

#include "publish/streams/users.h"
#include "secret_source.h"

namespace cerberus::rtsp {

// Returns what is wrong, without any password; empty: `users` is set (to nothing where no source is given).
std::string read_users(const SecretSource& source, std::vector<publish::User>& users);

}  // namespace cerberus::rtsp
