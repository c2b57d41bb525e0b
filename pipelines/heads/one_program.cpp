// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/one_program.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <thread>

namespace cerberus::heads {
namespace {

struct Address {
  sockaddr_un value{};
  socklen_t size;

  // A name that is too long for an address (107 bytes) is cut: two such heads count as one, which is the safe side.
  explicit Address(const std::string& place) {
    const std::string name = "cerberus-head " + place;
    const std::size_t length = std::min(name.size(), sizeof value.sun_path - 1);
    value.sun_family = AF_UNIX;
    std::memcpy(value.sun_path + 1, name.data(), length);  // a first byte of 0 makes the name an abstract one
    size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + length);
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&value); }
};

// The process that started `process`; 0: it is not known, or has ended.
long parent(long process) {
  std::ifstream status("/proc/" + std::to_string(process) + "/status");
  for (std::string word; status >> word;)
    if (long number = 0; word == "PPid:" && status >> number) return number > 1 ? number : 0;
  return 0;
}

// The process of the program whose helper holds the place; 0: it has given the place up or has ended, or is not known. Not
// the helper itself: killing that would leave a head turning.
long holder(const Address& address) {
  const int asking = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ucred credentials{};
  socklen_t size = sizeof credentials;
  const bool known = ::connect(asking, address.get(), address.size) == 0 &&
                     ::getsockopt(asking, SOL_SOCKET, SO_PEERCRED, &credentials, &size) == 0;
  ::close(asking);
  return known ? parent(credentials.pid) : 0;
}

int held_socket = -1;  // of this process's place, as long as it is not given up

}  // namespace

std::string hold_place(const std::string& place, std::chrono::milliseconds patience) {
  if (place.empty()) return {};
  const Address address(place);
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const int held = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (held < 0) return std::string("no socket could be made: ") + std::strerror(errno);
  while (::bind(held, address.get(), address.size) != 0) {
    const int wrong = errno;
    const long program = wrong == EADDRINUSE ? holder(address) : 0;
    if (wrong == EADDRINUSE &&
        Clock::now() - begin < (program > 0 ? std::min(patience, kMoment) : patience)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      continue;
    }
    ::close(held);
    if (wrong != EADDRINUSE)
      return "the head at " + place + " could not be reserved: " + std::strerror(wrong);
    return "another program" + (program > 0 ? " (process " + std::to_string(program) + ")" : "") +
           " drives the head at " + place + " already: end it first; a head has one controller";
  }
  ::listen(held, SOMAXCONN);  // so that the holder can be named; nothing is accepted
  held_socket = held;
  return {};
}

void give_up_place() {
  if (held_socket >= 0) ::shutdown(held_socket, SHUT_RDWR);  // holder() is refused from now on
  held_socket = -1;
}

}  // namespace cerberus::heads
