// SPDX-License-Identifier: LGPL-2.1-or-later
// What the page's server reads of a request by itself: method and path, Host, Origin, Range; a line each.
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "robot/page/access.h"
#include "robot/page/byte_range.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cerberus::robot;
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  std::array<std::string_view, 5> lines{};
  for (std::string_view& line : lines) {
    const std::size_t end = rest.find('\n');
    line = rest.substr(0, end);
    rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  }
  const auto& [method, path, host, origin, range] = lines;
  find_route(method, path);
  const std::vector<std::string> origins{"https://robot.example:8443"};
  // An address elsewhere is never this machine, and another scheme never the page.
  if (is_own_host(host, "garden", origins) && !host.starts_with('[') && host.find("evil") != host.npos)
    __builtin_trap();
  if (is_own_origin(origin, host, origins) && is_own_origin(origin, host, origins, true) &&
      origin != origins.front())
    __builtin_trap();
  constexpr std::uint64_t kSize = 1000, kMost = 100;
  const ByteRange part = parse_range(range, kSize, kMost);
  if (part.kind == ByteRange::Kind::part &&
      (part.first > part.last || part.last >= kSize || part.last - part.first >= kMost))
    __builtin_trap();
  return 0;
}
