// SPDX-License-Identifier: LGPL-2.1-or-later
// A head device behind the whole loop of a helper process, joined by a socket pair as in its process.
#pragma once

#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <future>
#include <string>
#include <thread>

#include "drivers/helper/helper_loop.h"

namespace cerberus::tests {

class ServedHead {
 public:
  using Clock = std::chrono::steady_clock;

  explicit ServedHead(drivers::HeadDevice& head, const char* timeout = "5") {
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_) != 0) std::abort();
    status_ = std::async(std::launch::async,
                         [this, &head] { return drivers::serve_head(ends_[1], ends_[1], head); });
    say(std::string("cerberus-head 1 timeout ") + timeout +
        " limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0");
  }
  ~ServedHead() {
    hang_up();
    if (status_.valid()) status_.wait();
    ::close(ends_[1]);
  }
  ServedHead(const ServedHead&) = delete;
  ServedHead& operator=(const ServedHead&) = delete;

  void say(std::string line) {
    line += '\n';
    if (::send(ends_[0], line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT) < 0)
      return;  // it ended, or still opens its head
  }
  // The end of the pipeline.
  void hang_up() {
    if (ends_[0] >= 0) ::close(ends_[0]);
    ends_[0] = -1;
  }
  // Sends `line` every 10 ms until the condition holds; false after 60 s.
  template <typename Condition>
  bool until(Condition holds, const std::string& line = "alive") {
    for (const auto end = Clock::now() + std::chrono::seconds(60); Clock::now() < end;
         std::this_thread::sleep_for(std::chrono::milliseconds(10))) {
      if (holds()) return true;
      say(line);
    }
    return false;
  }
  // Reads until a line begins like this; empty after 60 s.
  std::string line(const std::string& begin) {
    for (const auto end = Clock::now() + std::chrono::seconds(60); Clock::now() < end;) {
      while (const auto text = lines_.take())
        if (text->starts_with(begin)) return *text;
      char bytes[512];
      const ssize_t got = ::recv(ends_[0], bytes, sizeof bytes, MSG_DONTWAIT);
      if (got > 0) {
        lines_.append({bytes, static_cast<std::size_t>(got)});
        continue;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      say("alive");
    }
    return {};
  }
  // The process's exit status, at its end.
  int status() { return status_.get(); }

 private:
  int ends_[2];
  drivers::LineBuffer lines_;
  std::future<int> status_;
};

}  // namespace cerberus::tests
