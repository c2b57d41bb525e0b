// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a camera's services are. Requests, and with them credentials, go to the host that the user named and to no other,
// whatever address the camera claims: behind a router, or after a new DHCP lease, its claim is wrong anyway.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace cerberus::drivers::onvif {

struct Address {
  bool encrypted = false;  // https
  std::string host;        // an IPv6 address without its brackets
  int port = 80;
  std::string path;  // with its first slash, and the query

  std::string url() const;
  // "192.168.1.20" or "192.168.1.20:8080", for messages.
  std::string name() const;
};

// `http://HOST[:PORT][/PATH]`, `https://...` or only `HOST[:PORT]`; without a path that of the device service,
// /onvif/device_service. Returns why it is none, without the text: it could hold a password. Empty: good.
std::string parse_device(std::string_view text, Address& address);

// The service at `claimed` as a request reaches it from here: its path; its port as well where it names the same host and
// scheme. `named`: of the device service. Nothing: `claimed` is no such address.
std::optional<Address> reachable(std::string_view claimed, const Address& named);

}  // namespace cerberus::drivers::onvif
