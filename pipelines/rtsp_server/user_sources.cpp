// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/user_sources.h"

#include <sys/stat.h>

#include <cstdio>
#include <cstring>
#include <utility>

#include "text/file.h"

namespace cerberus::rtsp {
namespace {

constexpr std::size_t kLargestFile = 1 << 21;  // bytes: 1000 users with the longest passwords

std::string read_file(const std::string& path, std::string& lines) {
  text::File file = text::read_file(path, kLargestFile);
  using Fault = text::File::Fault;
  if (file.fault == Fault::irregular) return path + " is not a file";
  if (file.fault == Fault::too_large) return path + " is longer than 2 MiB: it is no list of users";
  if (file.fault == Fault::failed)
    return "the file of the users, " + path + ", cannot be read: " + std::strerror(file.error);
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRGRP | S_IROTH | S_IWGRP | S_IWOTH)))
    std::fprintf(stderr, "rtsp: warning: others may read or write the passwords in %s: chmod 600 it\n",
                 path.c_str());
  lines = std::move(file.text);
  return {};
}

}  // namespace

std::string read_users(const SecretSource& source, std::vector<publish::User>& users) {
  users.clear();
  std::string path, lines;
  std::string wrong = choose_secret(source, {"--users", "--users-env", "--users-credential"}, path, lines);
  if (wrong.empty() && !path.empty()) wrong = read_file(path, lines);
  if (!wrong.empty() || (path.empty() && source.environment.empty())) return wrong;
  wrong = publish::parse_users(lines, users);
  return wrong.empty() ? "" : (path.empty() ? source.environment : path) + ": " + wrong;
}

}  // namespace cerberus::rtsp
