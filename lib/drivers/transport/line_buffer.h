// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace cerberus::drivers {

inline constexpr std::size_t kMostLine = 512;  // bytes, the line feed included

// Cuts bytes that arrive in pieces into lines. A line that is too long is dropped whole.
class LineBuffer {
 public:
  void append(std::string_view bytes);
  // The oldest complete line without its line feed; nothing when there is none.
  std::optional<std::string> take();
  void clear() { *this = {}; }

 private:
  std::string bytes_;
  std::size_t line_begin_ = 0;  // of the line that is not complete yet
  bool overlong_ = false;       // the rest of a dropped line is still to come
};

}  // namespace cerberus::drivers
