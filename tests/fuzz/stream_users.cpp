// SPDX-License-Identifier: LGPL-2.1-or-later
// The users of the RTSP server, a file that a user writes. What is accepted reads the same when it is
// written again. (RTSP requests are parsed by gst-rtsp-server.)
#include <cstdint>
#include <cstdlib>

#include "publish/streams/users.h"

using namespace cerberus::publish;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::vector<User> users, again;
  const std::string wrong = parse_users({reinterpret_cast<const char*>(data), size}, users);
  if (wrong.empty() == users.empty()) std::abort();
  std::string text;
  for (const User& user : users) text += user.name + ":" + user.password + "\n";
  if (users.empty()) return 0;
  if (!parse_users(text, again).empty() || again.size() != users.size()) std::abort();
  for (std::size_t k = 0; k < users.size(); ++k)
    if (again[k].name != users[k].name || again[k].password != users[k].password) std::abort();
  return 0;
}
