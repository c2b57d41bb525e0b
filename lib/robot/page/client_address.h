// SPDX-License-Identifier: LGPL-2.1-or-later
// Whose request a proxy hands on.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace cerberus::robot {

// "192.168.1.7", "10.0.0.0/8", "fd00::/8": an address, or the network of so many leading bits.
bool is_network(std::string_view text);

// The numeric address as it is compared: an IPv4 address that IPv6 carries (::ffff:10.0.0.1) is that of IPv4. Empty: it is
// none.
std::string plain_address(std::string_view address);

struct Client {
  std::string address;   // or "unknown via 127.0.0.1", where a trusted proxy names none
  bool proxied = false;  // a proxy has handed the request on, trusted or not
};

// Of a request that comes from `peer`, with its headers X-Forwarded-For and Forwarded (RFC 7239), several of a name joined
// by commas. They count where the peer is in one of the networks `trusted`: then the client is the right-most address that
// is in none of them, as every address left of it is what a stranger may have written. Where both headers are there and
// name different clients, one of them is not the proxy's, and the client is unknown, as it is where they name none.
Client client_of(std::string_view peer, std::span<const std::string> trusted,
                 std::string_view x_forwarded_for, std::string_view forwarded);
bool is_in(std::string_view address, std::span<const std::string> networks);

}  // namespace cerberus::robot
