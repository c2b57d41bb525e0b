// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>

extern char** environ;

namespace cerberus::drivers {
namespace {

std::string describe(int status) {
  if (WIFEXITED(status)) return "it ended with status " + std::to_string(WEXITSTATUS(status));
  if (WIFSIGNALED(status)) return "it was ended by signal " + std::to_string(WTERMSIG(status));
  return "it ended";
}

// As the shell reports it: signals that this process ignores or blocks are the child's to handle.
struct SpawnAttributes {
  posix_spawnattr_t value;
  SpawnAttributes() {
    posix_spawnattr_init(&value);
    sigset_t none, defaults;
    sigemptyset(&none);
    sigemptyset(&defaults);
    for (const int signal : {SIGPIPE, SIGTERM, SIGHUP}) sigaddset(&defaults, signal);
    posix_spawnattr_setsigmask(&value, &none);
    posix_spawnattr_setsigdefault(&value, &defaults);
    // A group of its own: Ctrl-C reaches the pipeline, which then stops the head in order.
    posix_spawnattr_setpgroup(&value, 0);
    posix_spawnattr_setflags(&value, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  }
  ~SpawnAttributes() { posix_spawnattr_destroy(&value); }
};

struct SpawnActions {
  posix_spawn_file_actions_t value;
  explicit SpawnActions(int fd) {
    posix_spawn_file_actions_init(&value);
    posix_spawn_file_actions_adddup2(&value, fd, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&value, fd, STDOUT_FILENO);
  }
  ~SpawnActions() { posix_spawn_file_actions_destroy(&value); }
};

}  // namespace

std::string HelperProcess::start(const std::vector<std::string>& arguments) {
  hang_up();
  if (!end()) return "the helper that ran before has not ended yet";
  int pair[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
    return std::string("no socket pair for the helper: ") + std::strerror(errno);
  std::vector<char*> words;
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  const SpawnActions actions(pair[1]);
  const SpawnAttributes attributes;
  const int failed =
      ::posix_spawnp(&pid_, words.front(), &actions.value, &attributes.value, words.data(), environ);
  ::close(pair[1]);
  if (failed != 0) {
    ::close(pair[0]);
    pid_ = -1;
    return arguments.front() + " cannot be started: " + std::strerror(failed);
  }
  fd_ = pair[0];
  ::fcntl(fd_, F_SETFL, ::fcntl(fd_, F_GETFL) | O_NONBLOCK);
  return {};
}

bool HelperProcess::send(std::string_view bytes) noexcept {
  if (fd_ < 0) return false;
  // A line is far smaller than a socket's buffer: it goes in whole, or the helper has stopped reading.
  return ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(bytes.size());
}

bool HelperProcess::receive(std::string& bytes) {
  std::array<char, 4096> piece;
  while (fd_ >= 0) {
    const ssize_t got = ::recv(fd_, piece.data(), piece.size(), 0);
    if (got > 0) {
      bytes.append(piece.data(), static_cast<std::size_t>(got));
      continue;
    }
    if (got < 0 && errno == EINTR) continue;
    return got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
  }
  return false;
}

void HelperProcess::hang_up() noexcept {
  if (fd_ < 0) return;
  ::close(fd_);
  fd_ = -1;
  asked_ = false;
  hung_up_ = std::chrono::steady_clock::now();
}

void HelperProcess::kill() noexcept {
  hang_up();
  if (pid_ > 0) ::kill(-pid_, SIGKILL);
}

std::optional<std::string> HelperProcess::end() noexcept {
  if (pid_ < 0) return "";
  int status = 0;
  if (::waitpid(pid_, &status, WNOHANG) == 0) {
    const auto since = std::chrono::steady_clock::now() - hung_up_;
    if (fd_ < 0 && !asked_ && since >= kPatience) asked_ = ::kill(-pid_, SIGTERM) == 0;
    if (fd_ < 0 && since >= kPatience + kKillPatience) kill();
    return std::nullopt;
  }
  pid_ = -1;
  return describe(status);
}

void HelperProcess::finish() noexcept {
  hang_up();
  while (!end()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

}  // namespace cerberus::drivers
