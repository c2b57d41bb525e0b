// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/network_input.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace cerberus::vision {

std::optional<std::array<double, 3>> plane_numbers(std::string_view text) {
  std::array<double, 3> numbers{};
  std::size_t count = 0;
  const char *at = text.data(), *const end = at + text.size();
  const auto skip_blanks = [&] { at = std::find_if(at, end, [](char c) { return c != ' '; }); };
  for (;;) {
    skip_blanks();
    if (count == numbers.size()) return std::nullopt;
    const auto read = std::from_chars(at, end, numbers[count]);
    if (read.ec != std::errc() || !std::isfinite(numbers[count])) return std::nullopt;
    at = read.ptr, ++count;
    skip_blanks();
    if (at == end) break;
    if (*at++ != ',') return std::nullopt;
  }
  if (count == 1) numbers.fill(numbers[0]);
  return count == 2 ? std::nullopt : std::optional(numbers);
}

}  // namespace cerberus::vision
