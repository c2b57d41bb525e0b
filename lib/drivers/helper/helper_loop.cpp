// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_loop.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "drivers/helper/head_server.h"

namespace cerberus::drivers {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kLongestWait{1};

Time now_is() {
  return std::chrono::duration_cast<Time>(Clock::now().time_since_epoch());
}

class Loop {
 public:
  Loop(int in, int out, HeadDevice& device)
      : in_(in), out_(out), device_(device), server_(device, [this](std::string line) { send(line); }) {}

  int run(void (*ends)()) {
    while (!input_ended_ && !server_.ended()) {
      wait(server_.serve(now_is()));
      read();
    }
    if (ends) ends();
    if (!server_.greeted() || server_.failed()) return 2;
    finish();
    return 0;
  }

 private:
  void wait(Time until) {
    fds_.assign(1, pollfd{in_, POLLIN, 0});
    if (server_.greeted()) device_.watch(fds_);
    // Not in milliseconds: a stepper's deadlines lie closer together than that.
    const Time left = until == motion::kNever
                          ? Time(kLongestWait)
                          : std::clamp(until - now_is(), Time::zero(), Time(kLongestWait));
    const timespec patience{left.count() / 1'000'000'000, left.count() % 1'000'000'000};
    ::ppoll(fds_.data(), fds_.size(), &patience, nullptr);
  }

  void read() {
    if (!(fds_.front().revents & (POLLIN | POLLHUP | POLLERR))) return;
    std::array<char, 4096> bytes;
    const ssize_t got = ::read(in_, bytes.data(), bytes.size());
    if (got < 0 && errno == EINTR) return;
    if (got <= 0) {
      input_ended_ = true;
      return;
    }
    lines_.append({bytes.data(), static_cast<std::size_t>(got)});
    while (const auto line = lines_.take()) server_.obey(*line, now_is());
  }

  // What the pipeline does not read is dropped: a helper never waits for it.
  void send(std::string& line) {
    line += '\n';
    ::send(out_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  void finish() {
    Time now = now_is();
    for (Time next = server_.finish(now); next != motion::kNever; next = server_.finish(now)) {
      fds_.clear();
      device_.watch(fds_);
      // A step that is overdue lies in the past, and a negative patience would be an endless one.
      const auto patience = std::chrono::ceil<std::chrono::milliseconds>(std::max(next - now, Time::zero()));
      ::poll(fds_.data(), fds_.size(), static_cast<int>(patience.count()));
      now = now_is();
    }
  }

  int in_, out_;
  HeadDevice& device_;
  HeadServer server_;
  LineBuffer lines_;
  std::vector<pollfd> fds_;
  bool input_ended_ = false;
};

}  // namespace

int serve_head(int in, int out, HeadDevice& device, void (*ends)()) {
  return Loop(in, out, device).run(ends);
}

}  // namespace cerberus::drivers
