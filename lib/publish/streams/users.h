// SPDX-License-Identifier: LGPL-2.1-or-later
// The users of a streaming server, as a file lists them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace cerberus::publish {

struct User {
  std::string name, password;
};

// A line for each user, `NAME:PASSWORD`. Empty lines, and lines that begin with #, are skipped; a carriage return at the
// end of a line is none of the password. A name has 1 to 64 printable ASCII characters without blank, quote, backslash
// and colon; a password 1 to 1024 bytes without control characters. At most 1000 users.
//
// Returns what is wrong, with the number of the line and without any password; empty: `users` is what the text lists.
std::string parse_users(std::string_view text, std::vector<User>& users);

}  // namespace cerberus::publish
