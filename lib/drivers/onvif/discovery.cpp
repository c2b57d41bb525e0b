// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/discovery.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/random.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include "drivers/onvif/address.h"
#include "drivers/onvif/messages.h"

namespace cerberus::drivers::onvif {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostFound = 256;  // cameras; more answers are no cameras
constexpr std::string_view kNameScope = "onvif://www.onvif.org/name/";
constexpr std::chrono::milliseconds kAgain{250};  // a datagram may be lost: SOAP-over-UDP repeats each once

struct Socket {
  int fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ~Socket() {
    if (fd >= 0) ::close(fd);
  }
};

// RFC 4122, version 4.
std::string new_uuid() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size())) return {};
  bytes[6] = static_cast<unsigned char>((bytes[6] & 0x0f) | 0x40);
  bytes[8] = static_cast<unsigned char>((bytes[8] & 0x3f) | 0x80);
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    char digits[4];
    std::snprintf(digits, sizeof digits, "%02x", bytes[i]);
    if (i == 4 || i == 6 || i == 8 || i == 10) text += '-';
    text += digits;
  }
  return text;
}

// Sends to a multicast group through every interface, since the route of the default one leads elsewhere; to any other
// address once. False: no probe left.
bool send_probe(int fd, const std::string& message, const sockaddr_in& to) {
  const auto send = [&] {
    return ::sendto(fd, message.data(), message.size(), 0, reinterpret_cast<const sockaddr*>(&to),
                    sizeof to) == static_cast<ssize_t>(message.size());
  };
  if (!IN_MULTICAST(ntohl(to.sin_addr.s_addr))) return send();
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return send();
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> guard(list, ::freeifaddrs);
  bool sent = false;
  for (const ifaddrs* at = list; at; at = at->ifa_next) {
    const bool usable = at->ifa_addr && at->ifa_addr->sa_family == AF_INET && (at->ifa_flags & IFF_UP) &&
                        (at->ifa_flags & IFF_MULTICAST) && !(at->ifa_flags & IFF_LOOPBACK);
    if (!usable) continue;
    const in_addr from = reinterpret_cast<const sockaddr_in*>(at->ifa_addr)->sin_addr;
    if (::setsockopt(fd, IPPROTO_IP, IP_MULTICAST_IF, &from, sizeof from) == 0) sent |= send();
  }
  return sent;
}

// `%20` and other escapes; characters that are not printable are left out.
std::string unescaped(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 && digit(text[i + 2]) >= 0) {
      c = static_cast<char>(digit(text[i + 1]) * 16 + digit(text[i + 2]));
      i += 2;
    }
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f) out += c;
  }
  return out;
}

void read_answers(int fd, const std::string& id, std::vector<Found>& found) {
  std::array<char, 65536> bytes;
  sockaddr_in from{};
  socklen_t size = sizeof from;
  ssize_t got = 0;
  while ((got = ::recvfrom(fd, bytes.data(), bytes.size(), 0, reinterpret_cast<sockaddr*>(&from), &size)) >=
         0) {
    size = sizeof from;
    const auto document = XmlDocument::parse({bytes.data(), static_cast<std::size_t>(got)});
    if (!document) continue;
    std::string relates_to;
    const std::vector<ProbeMatch> matches = read_probe_matches(*document, relates_to);
    if (!relates_to.ends_with(id)) continue;  // urn:uuid: or uuid: in front
    char host[INET_ADDRSTRLEN] = "";
    ::inet_ntop(AF_INET, &from.sin_addr, host, sizeof host);
    for (const ProbeMatch& match : matches) {
      Found camera = read_match(match, host);
      const bool known = std::any_of(found.begin(), found.end(), [&](const Found& other) {
        return other.endpoint == camera.endpoint && other.device == camera.device;
      });
      if (!camera.device.empty() && !known && found.size() < kMostFound) found.push_back(std::move(camera));
    }
  }
}

}  // namespace

Found read_match(const ProbeMatch& match, std::string_view sender) {
  Found found;
  found.endpoint = unescaped(match.endpoint);
  for (const std::string& scope : match.scopes)
    if (scope.starts_with(kNameScope))
      found.name = unescaped(std::string_view(scope).substr(kNameScope.size()));
  for (const std::string& address : match.addresses) {
    Address device;
    if (!address.starts_with("http") || !parse_device(address, device).empty()) continue;
    const bool of_sender =
        device.host == sender;  // its other addresses may be of networks that are not reached
    if (found.device.empty() || of_sender) found.device = device.url();
    if (of_sender) break;
  }
  return found;
}

std::vector<Found> discover(std::chrono::milliseconds time, std::string& wrong, const ProbeTarget& to) {
  wrong.clear();
  const Socket socket;
  const std::string id = new_uuid();
  sockaddr_in target{};
  target.sin_family = AF_INET;
  target.sin_port = htons(to.port);
  if (socket.fd < 0 || id.empty() || ::inet_pton(AF_INET, to.address.c_str(), &target.sin_addr) != 1) {
    wrong = "there is no socket to look for cameras with";
    return {};
  }
  const std::string message = probe(id);
  std::vector<Found> found;
  const auto end = Clock::now() + time;
  for (auto again = Clock::now(); Clock::now() < end;) {
    if (Clock::now() >= again) {
      if (!send_probe(socket.fd, message, target) && wrong.empty())
        wrong = std::string("no probe for cameras could be sent: ") + std::strerror(errno);
      again += kAgain;
    }
    pollfd wait{socket.fd, POLLIN, 0};
    ::poll(&wait, 1, 20);
    read_answers(socket.fd, id, found);
  }
  if (!found.empty()) wrong.clear();
  return found;
}

std::string choose_found(const std::vector<Found>& found, bool has_login, std::string& device) {
  if (found.empty()) return "no ONVIF camera was found on this network: name it (device=http://HOST)";
  std::string list;
  for (const Found& camera : found) {
    if (!list.empty()) list.append(", ");
    list.append(camera.device);
    if (!camera.name.empty()) list.append(" (").append(camera.name).append(")");
  }
  if (found.size() > 1) return "several ONVIF cameras were found: name one (device=): " + list;
  if (has_login) return "a camera that was only found is sent no password: name it (device=): " + list;
  device = found.front().device;
  return {};
}

}  // namespace cerberus::drivers::onvif
