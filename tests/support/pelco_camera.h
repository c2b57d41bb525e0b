// SPDX-License-Identifier: LGPL-2.1-or-later
// A Pelco-D head for tests, written from the protocol's manual and not from our encoder: on a pseudo-terminal, without
// positions. It turns in real time, its steps a straight line up to 40 and 20 degrees a second.
#pragma once

#include <poll.h>
#include <pty.h>
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

namespace cerberus::tests {

class PelcoCamera {
 public:
  using Clock = std::chrono::steady_clock;
  // dead_time: from a frame until the head turns so.
  explicit PelcoCamera(std::chrono::milliseconds dead_time = {})
      : dead_time_(dead_time), last_(Clock::now()) {
    char name[128];
    if (::openpty(&fd_, &slave_, name, nullptr, nullptr) != 0) std::abort();
    device_ = std::string("serial:") + name;
    thread_ = std::thread([this] { run(); });
  }
  ~PelcoCamera() {
    end_ = true;
    thread_.join();
    ::close(fd_);
    ::close(slave_);
  }
  const std::string& device() const { return device_; }
  double pan() { return state(pan_); }  // degrees
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
    const auto now = Clock::now();
    for (; !coming_.empty() && coming_.front().from <= now; coming_.pop_front()) {
      turn_until(coming_.front().from);
      if (pan_speed_ != 0 && coming_.front().pan == 0) stopped_ = last_;
      pan_speed_ = coming_.front().pan;
      tilt_speed_ = coming_.front().tilt;
    }
    turn_until(now);
  }
  void run() {
    std::vector<std::uint8_t> bytes;
    while (!end_) {
      pollfd wait{fd_, POLLIN, 0};
      if (::poll(&wait, 1, 5) != 1) continue;
      std::uint8_t piece[256];
      const ssize_t got = ::read(fd_, piece, sizeof piece);
      if (got <= 0) continue;
      bytes.insert(bytes.end(), piece, piece + got);
      while (bytes.size() >= 7) {
        const std::uint8_t* f = bytes.data();
        if (f[0] == 0xff && f[6] == ((f[1] + f[2] + f[3] + f[4] + f[5]) & 255)) {
          const double pan = 40.0 * f[4] / 63, tilt = 20.0 * f[5] / 63;
          const std::lock_guard guard(lock_);
          coming_.push_back({Clock::now() + dead_time_,
                             f[3] & 2   ? pan
                             : f[3] & 4 ? -pan
                                        : 0,
                             f[3] & 8    ? tilt
                             : f[3] & 16 ? -tilt
                                         : 0});
          bytes.erase(bytes.begin(), bytes.begin() + 7);
        } else {
          bytes.erase(bytes.begin());
        }
      }
    }
  }

  std::chrono::milliseconds dead_time_;
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
