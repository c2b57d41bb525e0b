// SPDX-License-Identifier: LGPL-2.1-or-later
// A VISCA camera for tests, written from the vendors' command lists and not from our encoder: on a pseudo-terminal, UDP
// or TCP on loopback, with faults. It turns in real time by its own speed table and keeps what it was sent.
#pragma once

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <poll.h>
#include <pty.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "support/stepped_time.h"

namespace cerberus::tests {

struct ViscaFaults {
  bool acknowledges = true;
  bool reports = true;        // answers position inquiries
  bool versions = false;      // answers the inquiry of its version
  bool zooms = false;         // has a zoom; without one it refuses its commands, as Sony's cameras do
  bool header = true;         // expects the header of VISCA over IP, over UDP
  int refuses = 0;            // as many moves are answered by "buffer full"
  int loses_answers = 0;      // as many acknowledgements are lost
  int swallows_moves = 0;     // likewise of moves
  int swallows_stops = 0;     // as many stops are neither obeyed nor answered
  int address = 1;            // on a serial line
  bool garbles = false;       // its answers arrive as at another baud rate
  bool strict = false;        // refuses a sequence number that is not the next one, as Sony's cameras do
  int most_number = -1;       // refuses a higher one; -1: none
  int answers_number = -1;    // answers with this one, whatever it was asked with; -1: with the same
  bool bare_answers = false;  // without a header
  std::chrono::milliseconds delay{0};      // of each answer
  std::chrono::milliseconds dead_time{0};  // from a move or stop until the camera turns so
};

class ViscaCamera {
 public:
  using Clock = std::chrono::steady_clock;
  enum class Line { serial, udp, tcp };

  // time: it has no thread then, and step() lets it work.
  explicit ViscaCamera(Line line, ViscaFaults faults = {}, const SteppedTime* time = nullptr)
      : line_(line), faults_(faults), time_(time) {
    if (line == Line::serial) {
      char name[128];
      if (::openpty(&fd_, &slave_, name, nullptr, nullptr) != 0) std::abort();
      device_ = std::string("serial:") + name;
    } else {
      const int socket = ::socket(AF_INET, line == Line::udp ? SOCK_DGRAM : SOCK_STREAM, 0);
      sockaddr_in at{};
      at.sin_family = AF_INET;
      at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      socklen_t size = sizeof at;
      if (::bind(socket, reinterpret_cast<sockaddr*>(&at), size) != 0) std::abort();
      ::getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size);
      if (line == Line::tcp) {
        ::listen(socket, 1);
        listener_ = socket;
      } else {
        fd_ = socket;
      }
      device_ =
          (line == Line::udp ? "udp:127.0.0.1:" : "tcp:127.0.0.1:") + std::to_string(ntohs(at.sin_port));
    }
    last_ = now_of(time_);
    if (!time_) thread_ = std::thread([this] { run(); });
  }
  ~ViscaCamera() {
    end_ = true;
    if (thread_.joinable()) thread_.join();
    for (const int fd : {fd_, slave_, listener_})
      if (fd >= 0) ::close(fd);
  }
  const std::string& device() const { return device_; }
  // Obeys what has come, and sends the answers that are due.
  void step() {
    while (work(0)) {
    }
    for (; !late_.empty() && late_.front().due <= now_of(time_); late_.pop_front())
      deliver(late_.front().message);
  }
  void set_zoom(int position) { zoom_ = position, zooms_ = true; }
  int zoom() const { return zoom_; }
  double pan() { return state(pan_.position); }  // degrees
  double tilt() { return state(tilt_.position); }
  double speed() { return state(pan_.speed); }  // degrees a second
  int moves() const { return moves_; }
  int homes() const { return homes_; }
  // When the camera stopped last.
  Clock::time_point stopped() {
    const std::lock_guard guard(lock_);
    return stopped_;
  }
  // In the test's own time: as many stops are neither obeyed nor answered from now on.
  void swallow_stops(int stops) { faults_.swallows_stops = stops; }
  // The degrees that it reports from now on for where its pan is; not finite: it does not answer.
  void set_reported_pan(std::function<double(double)> reported) {
    const std::lock_guard guard(lock_);
    reported_pan_ = std::move(reported);
  }
  // The next reset of the sequence number is lost.
  void drop_reset() { drops_resets_ = 1; }
  // While it has no power, what comes is lost, and it stands.
  void set_power(bool on) {
    const std::lock_guard guard(lock_);
    advance();
    powered_ = on;
    coming_.clear();
    pan_.speed = tilt_.speed = 0;
  }
  // The camera's cable is pulled (TCP: the connection ends).
  void hang_up() { hang_up_ = true; }

 private:
  struct Axis {
    double position = 0, speed = 0;
  };
  struct Drive {
    Clock::time_point from;
    double pan, tilt;  // degrees a second
  };
  static constexpr double kHomeSpeed = 60;

  std::uint8_t to_me() const { return static_cast<std::uint8_t>(0x80 | faults_.address); }
  double state(double& value) {
    const std::lock_guard guard(lock_);
    advance();
    return value;
  }
  void turn_until(Clock::time_point time) {
    const double dt = std::chrono::duration<double>(time - last_).count();
    for (Axis* axis : {&pan_, &tilt_}) {
      const double most = kHomeSpeed * dt;
      axis->position += homing_ ? std::clamp(-axis->position, -most, most) : axis->speed * dt;
    }
    last_ = time;
  }
  void advance() {
    const auto now = now_of(time_);
    for (; !coming_.empty() && coming_.front().from <= now; coming_.pop_front()) {
      turn_until(coming_.front().from);
      homing_ = false;
      const bool moved = pan_.speed != 0;
      pan_.speed = coming_.front().pan;
      tilt_.speed = coming_.front().tilt;
      if (moved && pan_.speed == 0) stopped_ = coming_.front().from;
    }
    turn_until(now);
  }
  double report(double pan) {
    const std::lock_guard guard(lock_);
    return reported_pan_ ? reported_pan_(pan) : pan;
  }
  bool has_come_home() {
    const std::lock_guard guard(lock_);
    advance();
    return homing_ && pan_.position == 0 && tilt_.position == 0;
  }
  void run() {
    while (!end_) work(5);
  }
  // Waits for so many milliseconds. Returns whether something came.
  bool work(int patience) {
    if (has_come_home()) {
      homing_ = false;
      answer({0x90, 0x52, 0xff});
    }
    if (hang_up_.exchange(false) && line_ == Line::tcp && fd_ >= 0) ::close(fd_), fd_ = -1;
    if (line_ == Line::tcp && fd_ < 0) {
      pollfd wait{listener_, POLLIN, 0};
      if (::poll(&wait, 1, patience) == 1) fd_ = ::accept(listener_, nullptr, nullptr);
      return fd_ >= 0;
    }
    pollfd wait{fd_, POLLIN, 0};
    if (::poll(&wait, 1, patience) != 1) return false;
    std::uint8_t piece[512];
    peer_size_ = sizeof peer_;
    const ssize_t got = line_ == Line::udp ? ::recvfrom(fd_, piece, sizeof piece, 0,
                                                        reinterpret_cast<sockaddr*>(&peer_), &peer_size_)
                                           : ::read(fd_, piece, sizeof piece);
    if (got <= 0) {
      if (line_ == Line::tcp) ::close(fd_), fd_ = -1;
      return true;
    }
    if (!powered_) return true;
    std::size_t skip = 0;
    if (line_ == Line::udp && faults_.header) {
      if (got < 9) return true;
      if (piece[0] == 0x02) {  // the sequence number begins anew
        if (drops_resets_ > 0)
          --drops_resets_;
        else
          next_ = 0;
        return true;
      }
      skip = 8;
      std::memcpy(header_, piece, 8);
      const std::uint32_t number =
          static_cast<std::uint32_t>(piece[4]) << 24 | piece[5] << 16 | piece[6] << 8 | piece[7];
      if ((faults_.strict && number != next_) ||
          (faults_.most_number >= 0 && number > static_cast<std::uint32_t>(faults_.most_number))) {
        const std::uint8_t error[10] = {0x02, 0x01, 0, 2, piece[4], piece[5], piece[6], piece[7], 0x0f, 0x01};
        ::sendto(fd_, error, sizeof error, 0, reinterpret_cast<sockaddr*>(&peer_), peer_size_);
        return true;
      }
      next_ = number + 1;
    }
    bytes_.insert(bytes_.end(), piece + skip, piece + got);
    for (std::size_t i = 0; i < bytes_.size(); ++i)
      if (bytes_[i] == 0xff) {
        obey({bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(i) + 1});
        bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(i) + 1);
        i = static_cast<std::size_t>(-1);
      }
    return true;
  }
  void answer(std::vector<std::uint8_t> message) {
    message[0] = static_cast<std::uint8_t>(0x80 | faults_.address << 4);
    if (faults_.garbles) message.assign(message.size(), 0x1c);
    if (!time_) std::this_thread::sleep_for(faults_.delay);
    if (line_ == Line::udp && faults_.header && faults_.answers_number >= 0) {
      std::fill(header_ + 4, header_ + 7, std::uint8_t{0});
      header_[7] = static_cast<std::uint8_t>(faults_.answers_number);
    }
    if (line_ == Line::udp && faults_.header && !faults_.bare_answers) {
      const std::uint8_t head[8] = {
          1,          0x11,       0,          static_cast<std::uint8_t>(message.size()),
          header_[4], header_[5], header_[6], header_[7]};
      message.insert(message.begin(), head, head + 8);
    }
    if (time_ && faults_.delay.count() > 0)
      late_.push_back({now_of(time_) + faults_.delay, std::move(message)});
    else
      deliver(message);
  }
  void deliver(const std::vector<std::uint8_t>& message) {
    if (line_ == Line::udp)
      ::sendto(fd_, message.data(), message.size(), 0, reinterpret_cast<sockaddr*>(&peer_), peer_size_);
    else if (line_ == Line::tcp)
      ::send(fd_, message.data(), message.size(), MSG_NOSIGNAL);
    else if (::write(fd_, message.data(), message.size()) < 0)
      return;
  }
  void obey(const std::vector<std::uint8_t>& m) {
    if (m.size() == 5 && m[0] == to_me() && m[1] == 0x09 && m[2] == 0x06 && m[3] == 0x12) {
      if (!faults_.reports) return;
      const double reported = report(pan());
      if (!std::isfinite(reported)) return;
      std::vector<std::uint8_t> reply{0x90, 0x50};
      for (const double angle : {reported, tilt()}) {
        const auto units = static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(angle * 14.4)));
        for (int shift = 12; shift >= 0; shift -= 4)
          reply.push_back(static_cast<std::uint8_t>(units >> shift & 15));
      }
      reply.push_back(0xff);
      return answer(reply);
    }
    // CAM_VersionInq: vendor, model, ROM revision, sockets
    if (m.size() == 5 && m[1] == 0x09 && m[2] == 0x00 && m[3] == 0x02) {
      if (faults_.versions) answer({0x90, 0x50, 0x00, 0x20, 0x05, 0x11, 0x01, 0x03, 0x02, 0xff});
      return;
    }
    if (m.size() == 5 && m[1] == 0x09 && m[2] == 0x04 && m[3] == 0x47) {  // CAM_ZoomPosInq
      const int z = zoom_;
      if (!zooms_) return answer({0x90, 0x60, 0x02, 0xff});
      const auto nibble = [z](int shift) { return static_cast<std::uint8_t>(z >> shift & 15); };
      return answer({0x90, 0x50, nibble(12), nibble(8), nibble(4), nibble(0), 0xff});
    }
    if (m.size() == 9 && m[1] == 0x01 && m[2] == 0x04 && m[3] == 0x47) {  // CAM_Zoom Direct
      if (!zooms_) return answer({0x90, 0x60, 0x02, 0xff});
      zoom_ = m[4] << 12 | m[5] << 8 | m[6] << 4 | m[7];
      if (!faults_.acknowledges) return;
      answer({0x90, 0x41, 0xff});
      return answer({0x90, 0x51, 0xff});
    }
    if (m == std::vector<std::uint8_t>{to_me(), 0x01, 0x06, 0x04, 0xff}) {
      {
        const std::lock_guard guard(lock_);
        advance();
        coming_.clear();
        pan_.speed = tilt_.speed = 0;
        homing_ = true;
      }
      ++homes_;
      return answer({0x90, 0x42, 0xff});
    }
    if (m.size() != 9 || m[0] != to_me() || m[1] != 1 || m[2] != 6 || m[3] != 1) return;
    const bool stop = m[6] == 3 && m[7] == 3;
    if (stop && faults_.swallows_stops > 0) return void(--faults_.swallows_stops);
    if (!stop && faults_.swallows_moves > 0) return void(--faults_.swallows_moves);
    if (!stop && faults_.refuses > 0) {
      --faults_.refuses;
      return answer({0x90, 0x60, 0x03, 0xff});
    }
    {
      static constexpr double kSpeeds[] = {.3, 1,  1.5, 2.2, 2.4, 2.6, 2.8, 3.0, 3.2, 3.4, 3.8, 4.5, 6,
                                           9,  15, 19,  25,  32,  38,  45,  58,  75,  88,  105, 120};
      static constexpr double kTilts[] = {.3, 1,  1.5, 2.2, 3.6, 4.7, 6,  8,  10, 12,
                                          15, 18, 23,  30,  39,  48,  59, 69, 80};
      const std::lock_guard guard(lock_);
      coming_.push_back({now_of(time_) + faults_.dead_time,
                         m[6] == 3 ? 0 : kSpeeds[m[4]] * (m[6] == 2 ? 1 : -1),
                         m[7] == 3 ? 0 : kTilts[std::min<int>(m[5], 18)] * (m[7] == 1 ? 1 : -1)});
      advance();
      if (!stop) ++moves_;
    }
    if (!faults_.acknowledges) return;
    if (faults_.loses_answers > 0) return void(--faults_.loses_answers);
    answer({0x90, 0x41, 0xff});
    answer({0x90, 0x51, 0xff});
  }

  Line line_;
  ViscaFaults faults_;
  std::atomic<bool> zooms_ = faults_.zooms;
  std::atomic<int> zoom_ = 0;  // 0000 to 4000 hex
  const SteppedTime* time_;
  std::vector<std::uint8_t> bytes_;  // of a message that is not complete yet
  std::string device_;
  int fd_ = -1, slave_ = -1, listener_ = -1;
  std::uint8_t header_[8]{};
  sockaddr_storage peer_{};
  socklen_t peer_size_ = 0;
  std::mutex lock_;
  std::function<double(double)> reported_pan_;
  Axis pan_, tilt_;  // degrees, degrees a second
  std::deque<Drive> coming_;
  struct Late {
    Clock::time_point due;
    std::vector<std::uint8_t> message;
  };
  std::deque<Late> late_;  // answers
  std::atomic<bool> homing_{false};
  std::atomic<int> homes_{0};
  std::uint32_t next_ = 0;
  Clock::time_point last_, stopped_;
  std::atomic<int> moves_{0}, drops_resets_{0};
  std::atomic<bool> end_{false}, hang_up_{false}, powered_{true};
  std::thread thread_;
};

}  // namespace cerberus::tests
