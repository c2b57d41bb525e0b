// SPDX-License-Identifier: LGPL-2.1-or-later
// A child process joined by a socket pair, which is its standard input and output. It ends by itself when the socket is
// closed, as the line protocol demands, and is asked by SIGTERM if it does not. A killed helper cannot switch its motors
// off: only one that hangs is killed, and the caller starts another. Signals go to its process group: what it has started
// may hold the device.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::drivers {

class HelperProcess {
 public:
  HelperProcess() = default;
  ~HelperProcess() { finish(); }
  HelperProcess(const HelperProcess&) = delete;
  HelperProcess& operator=(const HelperProcess&) = delete;

  // Runs the program arguments[0], looked for in PATH where it has no slash. Returns why it could not; empty: it runs.
  std::string start(const std::vector<std::string>& arguments);
  bool running() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  pid_t pid() const { return pid_; }  // for a test of what the head does without its helper
  // Never blocks. False: the child is gone, or has not read for so long that the socket is full.
  bool send(std::string_view bytes) noexcept;
  // Appends what has arrived. False: the child has closed its end.
  bool receive(std::string& bytes);
  // Closes the socket: the helper stops its head and ends. Never blocks.
  void hang_up() noexcept;
  // hang_up(), and kills the child. Never blocks: end() says when it is gone.
  void kill() noexcept;
  // After hang_up(): how the child ended, in words; nothing while it still runs. Asks it by SIGTERM once kPatience has
  // passed since hang_up(), and kills it after kKillPatience more. Never blocks. An empty text where no child was running.
  std::optional<std::string> end() noexcept;
  // hang_up(), and waits for the end.
  void finish() noexcept;

  static constexpr std::chrono::milliseconds kPatience{6000};
  static constexpr std::chrono::milliseconds kKillPatience{2000};

 private:
  int fd_ = -1;
  pid_t pid_ = -1;
  bool asked_ = false;  // by SIGTERM
  std::chrono::steady_clock::time_point hung_up_{};
};

}  // namespace cerberus::drivers
