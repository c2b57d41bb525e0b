// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/user_sources.h"

#include <glib.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace cerberus::rtsp {
namespace {

constexpr std::streamsize kLargestFile = 1 << 21;  // bytes: 1000 users with the longest passwords

std::string read_file(const std::string& path, std::vector<publish::User>& users) {
  struct stat status = {};
  if (stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode)) return path + " is not a file";
  std::ifstream file(path, std::ios::binary);
  if (!file) return "the file of the users, " + path + ", cannot be read: " + std::strerror(errno);
  std::string text(kLargestFile, '\0');
  file.read(text.data(), kLargestFile);
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (status.st_mode & (S_IRGRP | S_IROTH | S_IWGRP | S_IWOTH))
    std::fprintf(stderr, "rtsp: warning: others may read or write the passwords in %s: chmod 600 it\n",
                 path.c_str());
  const std::string wrong = publish::parse_users(text, users);
  return wrong.empty() ? "" : path + ": " + wrong;
}

}  // namespace

std::string read_users(const UserSource& source, std::vector<publish::User>& users) {
  users.clear();
  const int sources = !source.file.empty() + !source.environment.empty() + !source.credential.empty();
  if (sources > 1) return "give one of --users, --users-env and --users-credential";
  if (!source.file.empty()) return read_file(source.file, users);
  if (!source.environment.empty()) {
    const char* value = g_getenv(source.environment.c_str());
    if (!value) return "the environment has no variable " + source.environment + " (--users-env)";
    const std::string wrong = publish::parse_users(value, users);
    return wrong.empty() ? "" : source.environment + ": " + wrong;
  }
  if (!source.credential.empty()) {
    const char* folder = g_getenv("CREDENTIALS_DIRECTORY");
    if (!folder) return "--users-credential needs a service of systemd with LoadCredential=";
    if (source.credential.find('/') != std::string::npos) return "a credential's name has no slash";
    return read_file(std::string(folder) + "/" + source.credential, users);
  }
  return {};
}

}  // namespace cerberus::rtsp
