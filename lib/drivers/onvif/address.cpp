// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/address.h"

#include <algorithm>
#include <charconv>

namespace cerberus::drivers::onvif {
namespace {

constexpr std::string_view kDeviceService = "/onvif/device_service";

bool is_host(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '.' ||
           c == '-' || c == '_';
  });
}

// An IPv6 address between brackets, with a zone or without.
bool is_bracketed_host(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == ':' ||
           c == '.' || c == '%';
  });
}

bool is_path(std::string_view text) {
  return text.starts_with('/') &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 0x7f; });
}

std::string parse(std::string_view text, Address& address) {
  address = {};
  if (text.starts_with("http://")) {
    text.remove_prefix(7);
  } else if (text.starts_with("https://")) {
    text.remove_prefix(8);
    address.encrypted = true;
    address.port = 443;
  } else if (text.find("://") != text.npos) {
    return "an ONVIF camera is written http://HOST, https://HOST or HOST";
  }
  const std::string_view authority = text.substr(0, text.find('/'));
  text.remove_prefix(authority.size());
  if (authority.find('@') != authority.npos)
    return "a camera's address holds no user and no password: give user= and password-file= in "
           "device-options";
  std::string_view host = authority, port;
  if (authority.starts_with('[')) {
    const auto end = authority.find(']');
    if (end == authority.npos) return "the brackets of the IPv6 address are not closed";
    host = authority.substr(1, end - 1);
    port = authority.substr(end + 1);
    if (!is_bracketed_host(host)) return "the host is no IPv6 address";
  } else {
    const auto colon = authority.find(':');
    host = authority.substr(0, colon);
    if (colon != authority.npos) port = authority.substr(colon);
    if (!is_host(host)) return "the host is no name and no address (IPv6 is written in brackets)";
  }
  address.host = host;
  if (!port.empty()) {
    const auto [end, error] = std::from_chars(port.data() + 1, port.data() + port.size(), address.port);
    if (port.front() != ':' || error != std::errc() || end != port.data() + port.size() || address.port < 1 ||
        address.port > 65535)
      return "the port is no number from 1 to 65535";
  }
  if (!text.empty() && !is_path(text)) return "the path holds characters that an address cannot hold";
  address.path = text;
  return {};
}

std::string in_address(const std::string& host) {
  if (host.find(':') == host.npos) return host;
  std::string text("[");
  return text.append(host).append("]");
}

bool equal_hosts(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [&](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace

std::string Address::url() const {
  std::string text(encrypted ? "https://" : "http://");
  return text.append(in_address(host)).append(":").append(std::to_string(port)).append(path);
}

std::string Address::name() const {
  std::string text = in_address(host);
  if (port != (encrypted ? 443 : 80)) text.append(":").append(std::to_string(port));
  return text;
}

std::string parse_device(std::string_view text, Address& address) {
  std::string wrong = parse(text, address);
  if (wrong.empty() && (address.path.empty() || address.path == "/")) address.path = kDeviceService;
  return wrong;
}

std::optional<Address> reachable(std::string_view claimed, const Address& named) {
  Address there;
  if (!parse(claimed, there).empty() || there.path.empty()) return std::nullopt;
  Address out = named;
  out.path = there.path;
  if (there.encrypted == named.encrypted && equal_hosts(there.host, named.host)) out.port = there.port;
  return out;
}

}  // namespace cerberus::drivers::onvif
