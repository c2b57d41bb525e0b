// SPDX-License-Identifier: LGPL-2.1-or-later
// A Pelco-D head for tests, written from the protocol's manual and not from our encoder: on a pseudo-terminal, without
// positions. It turns in real time, its steps a straight line up to 40 and 20 degrees a second.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "support/stepped_time.h"

namespace cerberus::tests {

class PelcoCamera {
 public:
  using Clock = std::chrono::steady_clock;
  // dead_time: from a frame until the head turns so.
  explicit PelcoCamera(std::chrono::milliseconds dead_time = {}) : dead_time_(dead_time) {
    char name[128];
    if (::openpty(&fd_, &slave_, name, nullptr, nullptr) != 0) std::abort();
    device_ = std::string("serial:") + name;
    last_ = Clock::now();
    thread_ = std::thread([this] { run(); });
  }
  // In a test's own time and behind a converter on UDP, whose datagrams have arrived when they are sent: step() lets it
  // work.
  PelcoCamera(std::chrono::milliseconds dead_time, const SteppedTime& time)
      : dead_time_(dead_time), time_(&time), last_(now_of(time_)) {
    fd_ = ::socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    if (::bind(fd_, reinterpret_cast<sockaddr*>(&at), size) != 0) std::abort();
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&at), &size);
    device_ = "udp:127.0.0.1:" + std::to_string(ntohs(at.sin_port));
  }
  ~PelcoCamera() {
    end_ = true;
    if (thread_.joinable()) thread_.join();
    ::close(fd_);
    if (slave_ >= 0) ::close(slave_);
  }
  const std::string& device() const { return device_; }
  // Obeys what has come.
  void step() {
    while (work(0)) {
    }
  }
  int frames() const { return frames_; }  // that were obeyed
  double pan() { return state(pan_); }    // degrees
  double tilt() { return state(tilt_); }
  double speed() { return state(pan_speed_); }  // degrees a second
  // When the head stopped last.
  Clock::time_point stopped() {
    const std::lock_guard guard(lock_);
    return stopped_;
  }

 private:
  struct Drive {
    Clock::time_point from;
    double pan, tilt;
  };
  double state(const double& value) {
    const std::lock_guard guard(lock_);
    advance();
    return value;
  }
  void turn_until(Clock::time_point time) {
    const double dt = std::chrono::duration<double>(time - last_).count();
    pan_ += pan_speed_ * dt;
    tilt_ += tilt_speed_ * dt;
    last_ = time;
  }
  void advance() {
    const auto now = now_of(time_);
    for (; !coming_.empty() && coming_.front().from <= now; coming_.pop_front()) {
      turn_until(coming_.front().from);
      if (pan_speed_ != 0 && coming_.front().pan == 0) stopped_ = last_;
      pan_speed_ = coming_.front().pan;
      tilt_speed_ = coming_.front().tilt;
    }
    turn_until(now);
  }
  void run() {
    while (!end_) work(5);
  }
  // Waits for so many milliseconds. Returns whether something came.
  bool work(int patience) {
    pollfd wait{fd_, POLLIN, 0};
    if (::poll(&wait, 1, patience) != 1) return false;
    std::uint8_t piece[256];
    const ssize_t got = ::read(fd_, piece, sizeof piece);
    if (got <= 0) return false;
    auto& bytes = bytes_;
    bytes.insert(bytes.end(), piece, piece + got);
    while (bytes.size() >= 7) {
      const std::uint8_t* f = bytes.data();
      if (f[0] == 0xff && f[6] == ((f[1] + f[2] + f[3] + f[4] + f[5]) & 255)) {
        const double pan = 40.0 * f[4] / 63, tilt = 20.0 * f[5] / 63;
        const std::lock_guard guard(lock_);
        coming_.push_back({now_of(time_) + dead_time_,
                           f[3] & 2   ? pan
                           : f[3] & 4 ? -pan
                                      : 0,
                           f[3] & 8    ? tilt
                           : f[3] & 16 ? -tilt
                                       : 0});
        ++frames_;
        bytes.erase(bytes.begin(), bytes.begin() + 7);
      } else {
        bytes.erase(bytes.begin());
      }
    }
    return true;
  }

  std::chrono::milliseconds dead_time_;
  const SteppedTime* time_ = nullptr;
  std::vector<std::uint8_t> bytes_;  // of a frame that is not complete yet
  std::atomic<int> frames_{0};
  std::string device_;
  int fd_ = -1, slave_ = -1;
  std::mutex lock_;
  double pan_ = 0, tilt_ = 0, pan_speed_ = 0, tilt_speed_ = 0;
  std::deque<Drive> coming_;
  Clock::time_point last_, stopped_;
  std::atomic<bool> end_{false};
  std::thread thread_;
};

}  // namespace cerberus::tests
