// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/password.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace cerberus::heads {
namespace {

constexpr std::size_t kMostPassword = 1024;  // bytes

std::string read_file(const std::string& path, std::string& password) {
  std::ifstream file(path);
  if (!file) return "the password file " + path + " cannot be read: " + std::strerror(errno);
  if (!std::getline(file, password) || password.empty())
    return "the first line of the password file " + path + " is empty";
  if (password.back() == '\r') password.pop_back();
  if (password.size() <= kMostPassword) return {};
  password.clear();
  return "the password file " + path + " holds more than 1024 bytes in a line";
}

}  // namespace

std::string read_password(const SecretSource& source, std::string& password) {
  std::string path;
  const SecretOptions options{"password-file", "password-env", "password-credential"};
  std::string wrong = choose_secret(source, options, path, password);
  return wrong.empty() && !path.empty() ? read_file(path, password) : wrong;
}

}  // namespace cerberus::heads
