// SPDX-License-Identifier: LGPL-2.1-or-later
// The header Range of HTTP (RFC 9110, section 14): one range of bytes.
#pragma once

#include <cstdint>
#include <string_view>

namespace cerberus::robot {

struct ByteRange {
  enum class Kind : std::uint8_t {
    whole,  // no range is asked for, or none that counts: the whole is the answer (200)
    part,   // `first` to `last` (206)
    none,   // none of its bytes is there (416)
  };
  Kind kind = Kind::whole;
  std::uint64_t first = 0, last = 0;
};

// The answer to `header` for `size` bytes; a part has `most` (1 or more) bytes at most, which a server may choose.
ByteRange parse_range(std::string_view header, std::uint64_t size, std::uint64_t most);

}  // namespace cerberus::robot
