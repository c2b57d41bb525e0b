// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/streams/users.h"

#include <algorithm>

namespace cerberus::publish {
namespace {

constexpr std::size_t kMostUsers = 1000;
constexpr std::size_t kLongestName = 64, kLongestPassword = 1024;  // bytes

bool fits_name(char c) {
  return c > ' ' && c < 127 && c != '"' && c != '\\';
}

bool is_control(char c) {
  return static_cast<unsigned char>(c) < ' ' || c == 127;
}

// What is wrong with this line; empty: `user` is what it says.
std::string parse_line(std::string_view line, User& user) {
  const auto colon = line.find(':');
  if (colon == line.npos) return "has no colon: a user is NAME:PASSWORD";
  const std::string_view name = line.substr(0, colon), password = line.substr(colon + 1);
  if (name.empty()) return "has no name before the colon";
  if (name.size() > kLongestName) return "has a name of more than 64 characters";
  if (!std::all_of(name.begin(), name.end(), fits_name))
    return "has a name with a blank, a quote, a backslash or a letter beyond ASCII";
  if (password.empty()) return "has no password after the colon";
  if (password.size() > kLongestPassword) return "has a password of more than 1024 bytes";
  if (std::any_of(password.begin(), password.end(), is_control))
    return "has a password with a control character";
  user = {std::string(name), std::string(password)};
  return {};
}

}  // namespace

std::string parse_users(std::string_view text, std::vector<User>& users) {
  users.clear();
  for (std::size_t number = 1; !text.empty(); ++number) {
    const auto end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    if (line.empty() || line.front() == '#') continue;
    User user;
    std::string wrong = parse_line(line, user);
    const auto same_name = [&](const User& other) { return other.name == user.name; };
    if (wrong.empty() && std::any_of(users.begin(), users.end(), same_name))
      wrong = "names a user for the second time";
    if (wrong.empty() && users.size() == kMostUsers) wrong = "is the 1001st user: 1000 are the most";
    if (!wrong.empty()) {
      users.clear();
      return "line " + std::to_string(number) + " " + wrong;
    }
    users.push_back(std::move(user));
  }
  return users.empty() ? "there is no user in it: a user is a line NAME:PASSWORD" : "";
}

}  // namespace cerberus::publish
