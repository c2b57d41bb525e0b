// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/password.h"

#include <glib.h>

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

std::string read_password(const PasswordSource& source, std::string& password) {
  password.clear();
  const int sources = !source.file.empty() + !source.environment.empty() + !source.credential.empty();
  if (sources > 1) return "give one of password-file, password-env and password-credential";
  if (!source.file.empty()) return read_file(source.file, password);
  if (!source.environment.empty()) {
    const char* value = g_getenv(source.environment.c_str());
    if (!value || !*value) return "the environment has no variable " + source.environment + " (password-env)";
    password = value;
  }
  if (!source.credential.empty()) {
    const char* folder = g_getenv("CREDENTIALS_DIRECTORY");
    if (!folder) return "password-credential needs a service of systemd with LoadCredential=";
    if (source.credential.find('/') != std::string::npos) return "a credential's name has no slash";
    return read_file(std::string(folder) + "/" + source.credential, password);
  }
  return {};
}

}  // namespace cerberus::heads
