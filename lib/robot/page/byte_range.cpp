// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/byte_range.h"

#include <algorithm>
#include <charconv>
#include <optional>

namespace cerberus::robot {

namespace {

std::optional<std::uint64_t> read(std::string_view digits) {
  std::uint64_t value = 0;
  const auto done = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (done.ec != std::errc() || done.ptr != digits.data() + digits.size()) return std::nullopt;
  return value;
}

}  // namespace

ByteRange parse_range(std::string_view header, std::uint64_t size, std::uint64_t most) {
  constexpr std::string_view kUnit = "bytes=";
  const std::size_t dash = header.find('-');
  if (!header.starts_with(kUnit) || dash == header.npos) return {};
  const std::string_view from = header.substr(kUnit.size(), dash - kUnit.size()),
                         to = header.substr(dash + 1);
  const std::optional<std::uint64_t> first = read(from), last = read(to);
  if ((!first && !from.empty()) || (!last && !to.empty()) || (!first && !last)) return {};
  std::uint64_t begin = 0, end = size;  // end: the byte behind it
  if (!first) {
    begin = size - std::min(*last, size);
  } else {
    if (last && *last < *first) return {};
    begin = *first;
    if (last && *last < size) end = *last + 1;
  }
  if (begin >= end) return {ByteRange::Kind::none, 0, 0};
  return {ByteRange::Kind::part, begin, begin + std::min(end - begin, most) - 1};
}

}  // namespace cerberus::robot
