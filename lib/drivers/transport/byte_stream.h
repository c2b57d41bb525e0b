// SPDX-License-Identifier: LGPL-2.1-or-later
// A connection to a device by address, never blocking after open():
//
//   serial:/dev/ttyUSB0            at the baud rate given, 8 data bits, no parity, one stop bit, for this program alone
//   udp:192.0.2.7:52381            each write is one datagram
//   tcp:[2001:db8::7]:5678
//
// libserialport would open serial ports, too, but refuses the pseudo-terminals that the tests use.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace cerberus::drivers {

class ByteStream {
 public:
  ByteStream() = default;
  ~ByteStream() { close(); }
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  // Takes over the connection of `other`, which is then closed.
  void take(ByteStream& other) noexcept;

  // What is wrong with the text of an address, or the baud rate of a serial port; empty: nothing.
  static std::string check(const std::string& address, int baud);
  // Returns what is wrong, naming the device and what to do; empty: it is open. Blocks up to kConnectTimeout for tcp.
  // baud: of a serial port, one of 1200 to 115200.
  std::string open(const std::string& address, int baud);
  void close() noexcept;
  bool is_open() const { return fd_ >= 0; }
  int fd() const { return fd_; }
  bool datagrams() const { return datagrams_; }
  // False: the device is gone, or takes nothing now.
  bool write(std::span<const std::uint8_t> bytes) noexcept;
  // Appends what has come, for a datagram socket one datagram. False: nothing came; check is_open() for a lost device.
  bool read(std::vector<std::uint8_t>& bytes);

  static constexpr int kConnectTimeout = 2000;  // ms

 private:
  std::string open_serial(const std::string& path, int baud);
  std::string open_socket(const std::string& address, const std::string& place, bool datagrams);

  int fd_ = -1;
  bool datagrams_ = false, socket_ = false;
};

}  // namespace cerberus::drivers
