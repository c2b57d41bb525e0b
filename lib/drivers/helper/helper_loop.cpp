// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_loop.h"

#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds kLongestWait{1};

Time now_is() {
  return std::chrono::duration_cast<Time>(Clock::now().time_since_epoch());
}

class Server {
 public:
  Server(int in, int out, HeadDevice& device) : in_(in), out_(out), device_(device) {}

  int run() {
    if (!greet()) return 2;
    while (!ended_) {
      wait(std::min(device_.tick(now_is()), at_work() ? heard_ + timeout_ : motion::kNever));
      read();
      const Time now = now_is();
      if (at_work() && now - heard_ >= timeout_) {
        device_.stop(now);
        obeyed_ = false;
        silent_ = true;
      }
      report(now);
    }
    if (failed_) return 2;
    finish();
    return 0;
  }

 private:
  bool at_work() const { return obeyed_ || (device_.busy() && !silent_); }

  bool greet() {
    while (!ended_ && !greeted_) {
      wait(motion::kNever);
      read();
    }
    return greeted_;
  }

  void wait(Time until) {
    fds_.assign(1, pollfd{in_, POLLIN, 0});
    if (greeted_) device_.watch(fds_);
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
      ended_ = true;
      return;
    }
    lines_.append({bytes.data(), static_cast<std::size_t>(got)});
    while (const auto line = lines_.take()) obey(*line);
  }

  void obey(const std::string& text) {
    const auto line = parse_pipeline_line(text);
    if (!line) return;
    const Time now = heard_ = now_is();
    if (const auto* hello = std::get_if<HelloLine>(&*line)) {
      if (greeted_) return;
      timeout_ = hello->setup.helper_timeout;
      greeted_ = true;
      const std::string wrong = device_.open(hello->setup, now);
      if (!wrong.empty()) {
        send("fault " + wrong);
        ended_ = failed_ = true;
        return;
      }
      send(ready_line(device_.abilities()));
      return;
    }
    if (!greeted_) return;
    if (std::exchange(silent_, false)) send("stopped silence");
    if (const auto* move = std::get_if<MoveLine>(&*line)) {
      device_.move(move->pan, move->tilt, now);
      obeyed_ = true;
    } else if (std::get_if<HomeLine>(&*line)) {
      device_.home(now);
      obeyed_ = true;
    } else if (const auto* limits = std::get_if<LimitsLine>(&*line)) {
      device_.limit(limits->limits, now);
      obeyed_ = true;  // a head beyond them returns
    } else if (std::get_if<StopLine>(&*line)) {
      device_.stop(now);
      obeyed_ = false;
    } else if (std::get_if<QuitLine>(&*line)) {
      ended_ = true;
    }
  }

  void report(Time now) {
    if (ended_) return;
    if (const std::string fault = device_.fault(); fault != fault_) {
      fault_ = fault;
      send(fault.empty() ? "recovered" : "fault " + fault);
    }
    // After `recovered`, so that a command that answers it is obeyed.
    if (const bool pressed = device_.emergency(); pressed != emergency_) {
      emergency_ = pressed;
      send(pressed ? "emergency pressed" : "emergency released");
    }
    if (const auto pose = device_.take_pose(now)) send(pose_line(*pose));
    if (const auto speeds = device_.take_speeds(now)) send(speeds_line(*speeds));
    if (const auto homed = device_.take_homed(now)) send(homed_line(*homed));
  }

  // What the pipeline does not read is dropped: a helper never waits for it.
  void send(std::string line) {
    line += '\n';
    ::send(out_, line.data(), line.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  void finish() {
    if (!greeted_) return;
    Time now = now_is();
    device_.stop(now);
    const Time end = now + kStopPatience;
    do {
      const Time next = device_.tick(now);
      if (!device_.stopping()) return;
      fds_.clear();
      device_.watch(fds_);
      const Time left = std::min({next, end, now + std::chrono::milliseconds(20)}) - now;
      ::poll(fds_.data(), fds_.size(),
             static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
      now = now_is();
    } while (now < end);
  }

  int in_, out_;
  HeadDevice& device_;
  LineBuffer lines_;
  std::vector<pollfd> fds_;
  Time timeout_{}, heard_{};
  bool greeted_ = false, ended_ = false, failed_ = false;
  bool obeyed_ = false;  // a line that may move the head was carried out and no stop came after it
  bool silent_ = false;  // the head was stopped by the timeout
  bool emergency_ = false;
  std::string fault_;
};

}  // namespace

int serve_head(int in, int out, HeadDevice& device) {
  return Server(in, out, device).run();
}

}  // namespace cerberus::drivers
