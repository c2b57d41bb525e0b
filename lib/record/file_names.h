// SPDX-License-Identifier: LGPL-2.1-or-later
// The names of event files: a pattern with strftime's conversions and {camera}, {event}, {part}, expanded below the
// recorder's folder and never outside of it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace cerberus::record {

struct NameFacts {
  std::chrono::nanoseconds utc{};  // of the first frame, since 1970
  std::string_view camera;
  std::uint32_t event = 0, part = 1;
};

// Returns what is wrong with `pattern`, in words for a user; empty: nothing. Refused are absolute paths, a component
// `..`, an unknown {word}, control characters and an empty pattern.
std::string name_pattern_fault(std::string_view pattern);

// Expands a pattern without fault: conversions of strftime in local time, {camera} (in which everything but letters,
// digits, `-`, `_` and characters beyond ASCII becomes `_`; `camera` if it is empty), {event} and {part}. Parts after
// the first get `-2`, `-3`, ... appended where the pattern does not say {part}. The result is relative, without the
// ending (.mp4), and each of its components has at most 200 bytes.
std::string expand_name(std::string_view pattern, const NameFacts& facts);

}  // namespace cerberus::record
