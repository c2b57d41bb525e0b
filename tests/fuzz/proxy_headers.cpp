// SPDX-License-Identifier: LGPL-2.1-or-later
// Whose request a proxy hands on: the peer's address, X-Forwarded-For and Forwarded, a line each. Nothing that a stranger
// writes makes him another client: not before an untrusted proxy, nor to the left of what a trusted one adds.
#include <array>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "robot/page/client_address.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cerberus::robot;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::array<std::string_view, 3> lines{};
  for (std::string_view& line : lines) {
    const std::size_t end = rest.find('\n');
    line = rest.substr(0, end);
    rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  }
  const auto& [peer, by_x, by_standard] = lines;
  is_network(peer);
  const std::vector<std::string> trusted{"127.0.0.1", "10.0.0.0/8", "fd00::/8"};
  const Client client = client_of(peer, trusted, by_x, by_standard);
  std::string own = plain_address(peer);
  if (own.empty()) own = peer;
  if (!is_in(own, trusted)) {
    if (client.address != own) std::abort();
    return 0;
  }
  const bool known = plain_address(client.address) == client.address;
  constexpr std::string_view kUnknown = "unknown via ";
  if (!known && !(client.address.starts_with(kUnknown) &&
                  is_in(std::string_view(client.address).substr(kUnknown.size()), trusted)))
    std::abort();
  if (!known || is_in(client.address, trusted)) return 0;
  // An element more at the left of each header that is there.
  const std::string more_x = by_x.empty() ? "" : "198.51.100.66, " + std::string(by_x),
                    more_standard =
                        by_standard.empty() ? "" : "for=198.51.100.66, " + std::string(by_standard);
  if (client_of(peer, trusted, more_x, more_standard).address != client.address) std::abort();
  return 0;
}
