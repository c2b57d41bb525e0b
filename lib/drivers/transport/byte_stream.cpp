// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/transport/byte_stream.h"

#include <fcntl.h>
#include <grp.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "drivers/transport/exclusive.h"

namespace cerberus::drivers {
namespace {

constexpr std::array<std::pair<int, speed_t>, 8> kBauds{{{1200, B1200},
                                                         {2400, B2400},
                                                         {4800, B4800},
                                                         {9600, B9600},
                                                         {19200, B19200},
                                                         {38400, B38400},
                                                         {57600, B57600},
                                                         {115200, B115200}}};

// The group that may use the device, for a message.
std::string group_of(const std::string& path) {
  struct stat about{};
  if (::stat(path.c_str(), &about) != 0) return {};
  const group* owner = ::getgrgid(about.st_gid);
  return owner ? owner->gr_name : std::to_string(about.st_gid);
}

// B0: a serial port has no such rate.
speed_t code_of(int baud) {
  for (const auto& [rate, code] : kBauds)
    if (rate == baud) return code;
  return B0;
}

std::string why_not(const std::string& path) {
  const int error = errno;
  std::string text = "the serial port " + path + " cannot be opened: " + std::strerror(error);
  if (error == EACCES) text += " (its group is " + group_of(path) + ": add the user to it)";
  if (error == ENOENT || error == ENXIO || error == ENODEV)
    text += " (cerberus-heads list names those that are there)";
  if (error == EBUSY) text += ": " + program_with(path) + " has it open; end that first";
  return text;
}

}  // namespace

std::string ByteStream::check(const std::string& address, int baud) {
  const std::size_t colon = address.find(':');
  const std::string kind = address.substr(0, colon);
  const std::string place = colon == std::string::npos ? std::string() : address.substr(colon + 1);
  if (place.empty() || (kind != "serial" && kind != "udp" && kind != "tcp"))
    return "\"" + address + "\" is no device: write serial:/dev/ttyUSB0, udp:HOST:PORT or tcp:HOST:PORT";
  if (kind == "serial")
    return code_of(baud) == B0
               ? "a serial port has no baud rate " + std::to_string(baud) + ": take 1200 to 115200"
               : "";
  const std::size_t port = place.rfind(':');
  if (port == std::string::npos || port == 0 || port + 1 == place.size())
    return "\"" + address + "\" names no port: write HOST:PORT";
  return {};
}

std::string ByteStream::open(const std::string& address, int baud) {
  close();
  if (std::string wrong = check(address, baud); !wrong.empty()) return wrong;
  const std::size_t colon = address.find(':');
  const std::string place = address.substr(colon + 1);
  if (address.starts_with("serial:")) return open_serial(place, baud);
  return open_socket(address, place, address.starts_with("udp:"));
}

std::string ByteStream::open_serial(const std::string& path, int baud) {
  const speed_t speed = code_of(baud);
  fd_ = ::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  if (fd_ < 0) return why_not(path);
  termios mode{};
  if (::tcgetattr(fd_, &mode) != 0) {
    close();
    return path + " is no serial port";
  }
  // The lock first: the kernel lets root open a port that is exclusive.
  const int error = lock_device(fd_);
  if (error != 0 || ::ioctl(fd_, TIOCEXCL) != 0) {
    if (error != 0) errno = error;
    const std::string wrong = why_not(path);
    close();
    errno = error;
    return wrong;
  }
  ::cfmakeraw(&mode);
  mode.c_cflag = (mode.c_cflag & ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | PARENB)) | CLOCAL | CREAD;
  mode.c_iflag &= ~static_cast<tcflag_t>(IXON | IXOFF);
  ::cfsetispeed(&mode, speed);
  ::cfsetospeed(&mode, speed);
  ::tcsetattr(fd_, TCSANOW, &mode);
  ::tcflush(fd_, TCIOFLUSH);
  datagrams_ = socket_ = false;
  return {};
}

std::string ByteStream::open_socket(const std::string& address, const std::string& place, bool datagrams) {
  const std::size_t colon = place.rfind(':');
  std::string host = place.substr(0, colon);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  addrinfo hints{}, *first = nullptr;
  hints.ai_socktype = datagrams ? SOCK_DGRAM : SOCK_STREAM;
  const int failed = ::getaddrinfo(host.c_str(), place.c_str() + colon + 1, &hints, &first);
  if (failed != 0) return address + " cannot be found: " + ::gai_strerror(failed);
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> list(first, ::freeaddrinfo);
  int error = 0;
  for (const addrinfo* at = first; at; at = at->ai_next) {
    fd_ = ::socket(at->ai_family, at->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, at->ai_protocol);
    if (fd_ < 0) continue;
    datagrams_ = datagrams;
    socket_ = true;
    if (::connect(fd_, at->ai_addr, at->ai_addrlen) == 0) return {};
    error = errno;
    pollfd wait{fd_, POLLOUT, 0};
    socklen_t size = sizeof error;
    if (error == EINPROGRESS)
      error = ::poll(&wait, 1, kConnectTimeout) != 1                        ? ETIMEDOUT
              : ::getsockopt(fd_, SOL_SOCKET, SO_ERROR, &error, &size) == 0 ? error
                                                                            : errno;
    const int on = 1;
    if (error == 0) {
      ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      return {};
    }
    close();
  }
  return address + " cannot be reached: " + std::strerror(error);
}

void ByteStream::take(ByteStream& other) noexcept {
  close();
  fd_ = std::exchange(other.fd_, -1);
  datagrams_ = other.datagrams_;
  socket_ = other.socket_;
}

void ByteStream::close() noexcept {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

bool ByteStream::write(std::span<const std::uint8_t> bytes) noexcept {
  if (fd_ < 0) return false;
  const ssize_t written = socket_ ? ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                  : ::write(fd_, bytes.data(), bytes.size());
  if (written < 0 && errno != EAGAIN && errno != EINTR && !(datagrams_ && errno == ECONNREFUSED)) close();
  return written == static_cast<ssize_t>(bytes.size());
}

bool ByteStream::read(std::vector<std::uint8_t>& bytes) {
  if (fd_ < 0) return false;
  std::array<std::uint8_t, 2048> piece;
  const ssize_t got = ::read(fd_, piece.data(), piece.size());
  if (got > 0) {
    bytes.insert(bytes.end(), piece.begin(), piece.begin() + got);
    return true;
  }
  const bool harmless =
      got < 0 && (errno == EAGAIN || errno == EINTR || (datagrams_ && errno == ECONNREFUSED));
  if (!harmless && !datagrams_) close();
  return false;
}

}  // namespace cerberus::drivers
