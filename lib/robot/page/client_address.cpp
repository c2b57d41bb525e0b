// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/client_address.h"

#include <arpa/inet.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <vector>

namespace cerberus::robot {

namespace {

// As IPv6 has it; IPv4 in ::ffff:0:0/96 (RFC 4291, 2.5.5.2).
using Bytes = std::array<std::uint8_t, 16>;

constexpr std::array<std::uint8_t, 12> kMapped{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};

std::optional<Bytes> bytes_of(std::string_view text) {
  const std::string address(text);
  Bytes bytes{};
  if (inet_pton(AF_INET6, address.c_str(), bytes.data()) == 1) return bytes;
  std::ranges::copy(kMapped, bytes.begin());
  if (inet_pton(AF_INET, address.c_str(), bytes.data() + kMapped.size()) == 1) return bytes;
  return std::nullopt;
}

bool is_mapped(const Bytes& bytes) {
  return std::equal(kMapped.begin(), kMapped.end(), bytes.begin());
}

struct Network {
  Bytes address{};
  int bits = 128;
};

std::optional<Network> network_of(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto address = bytes_of(text.substr(0, slash));
  if (!address) return std::nullopt;
  if (slash == text.npos) return Network{*address, 128};
  const std::string_view length = text.substr(slash + 1);
  int bits = -1;
  const auto read = std::from_chars(length.data(), length.data() + length.size(), bits);
  const int most = is_mapped(*address) ? 32 : 128;
  if (read.ec != std::errc() || read.ptr != length.data() + length.size() || bits < 0 || bits > most)
    return std::nullopt;
  return Network{*address, 128 - most + bits};
}

bool contains(const Network& network, const Bytes& address) {
  for (int bit = 0; bit < network.bits; ++bit) {
    const auto at = static_cast<std::size_t>(bit / 8);
    if (((network.address[at] ^ address[at]) >> (7 - bit % 8) & 1) != 0) return false;
  }
  return true;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

enum class Quotes : std::uint8_t { none, hold };  // hold: a separator in quotes parts nothing

std::vector<std::string_view> parts_of(std::string_view text, char separator, Quotes quotes) {
  std::vector<std::string_view> parts;
  bool quoted = false;
  std::size_t begin = 0;
  for (std::size_t at = 0; at <= text.size(); ++at) {
    if (at < text.size() && text[at] == '"') quoted = quotes == Quotes::hold && !quoted;
    if (at < text.size() && (quoted || text[at] != separator)) continue;
    parts.push_back(trimmed(text.substr(begin, at - begin)));
    begin = at + 1;
  }
  return parts;
}

// The address of "1.2.3.4", "1.2.3.4:5678", "[::1]:5678", "\"[::1]\""; empty: it names none.
std::string node_address(std::string_view node) {
  if (node.size() >= 2 && node.front() == '"' && node.back() == '"') node = node.substr(1, node.size() - 2);
  if (node.starts_with('[')) {
    node = node.substr(1, node.find(']') - 1);
  } else if (std::ranges::count(node, ':') == 1) {
    node = node.substr(0, node.find(':'));
  }
  return plain_address(node);
}

// The node of "for=1.2.3.4;proto=https" (RFC 7239, 4).
std::string_view for_of(std::string_view element) {
  for (const std::string_view pair : parts_of(element, ';', Quotes::hold)) {
    const std::size_t sign = pair.find('=');
    const std::string_view key = pair.substr(0, sign);
    const bool is_for =
        key.size() == 3 && (key[0] | 32) == 'f' && (key[1] | 32) == 'o' && (key[2] | 32) == 'r';
    if (sign != pair.npos && is_for) return pair.substr(sign + 1);
  }
  return {};
}

// Requests of clients that are not known: those that this proxy hands on are counted as one, and not as its own.
std::string unknown_via(std::string_view peer) {
  return "unknown via " + std::string(peer);
}

// The right-most address of a header that is not trusted. Quotes have no meaning in X-Forwarded-For, where a stranger may
// write one to hide what the proxy adds; in Forwarded one that is not closed does so, and the header counts for nothing.
std::string right_most(std::string_view header, bool is_forwarded, std::string peer,
                       std::span<const std::string> trusted) {
  if (is_forwarded && std::ranges::count(header, '"') % 2 != 0) return unknown_via(peer);
  const std::vector<std::string_view> elements =
      parts_of(header, ',', is_forwarded ? Quotes::hold : Quotes::none);
  for (auto one = elements.rbegin(); one != elements.rend(); ++one) {
    std::string address = node_address(is_forwarded ? for_of(*one) : *one);
    if (address.empty()) return unknown_via(peer);  // "unknown", or a name of the proxy's own
    peer = std::move(address);
    if (!is_in(peer, trusted)) return peer;
  }
  return peer;
}

}  // namespace

bool is_network(std::string_view text) {
  return network_of(text).has_value();
}

std::string plain_address(std::string_view address) {
  const auto bytes = bytes_of(address);
  if (!bytes) return {};
  std::array<char, INET6_ADDRSTRLEN> text{};
  if (is_mapped(*bytes))
    inet_ntop(AF_INET, bytes->data() + kMapped.size(), text.data(), text.size());
  else
    inet_ntop(AF_INET6, bytes->data(), text.data(), text.size());
  return text.data();
}

bool is_in(std::string_view address, std::span<const std::string> networks) {
  const auto bytes = bytes_of(address);
  return bytes && std::ranges::any_of(networks, [&](const std::string& one) {
           const auto network = network_of(one);
           return network && contains(*network, *bytes);
         });
}

Client client_of(std::string_view peer, std::span<const std::string> trusted,
                 std::string_view x_forwarded_for, std::string_view forwarded) {
  std::string own = plain_address(peer);
  if (own.empty()) own = peer;
  Client client{own, !x_forwarded_for.empty() || !forwarded.empty()};
  if (!client.proxied || !is_in(own, trusted)) return client;
  const std::string by_x = right_most(x_forwarded_for, false, own, trusted),
                    by_standard = right_most(forwarded, true, own, trusted);
  if (forwarded.empty() || (!x_forwarded_for.empty() && by_x == by_standard))
    client.address = by_x;
  else if (x_forwarded_for.empty())
    client.address = by_standard;
  else
    client.address = unknown_via(own);
  return client;
}

}  // namespace cerberus::robot
