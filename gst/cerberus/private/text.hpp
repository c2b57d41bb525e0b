// SPDX-License-Identifier: LGPL-2.1-or-later
// Makes texts of users and files fit for messages.
#pragma once

#include <glib.h>

#include <string>
#include <string_view>

namespace cerberus {

// Messages must be UTF-8 without NUL: other bytes, and control characters except the line feed, are written as \xNN.
// noexcept: without memory the program ends, as in GLib.
inline std::string printable(std::string_view text) noexcept {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string result;
  while (!text.empty()) {
    // A first byte NUL counts as no character there.
    const gunichar character = g_utf8_get_char_validated(text.data(), static_cast<gssize>(text.size()));
    const bool valid = g_unichar_validate(character) && (character == '\n' || !g_unichar_iscntrl(character));
    const std::size_t length = valid ? static_cast<std::size_t>(g_unichar_to_utf8(character, nullptr)) : 1;
    if (valid) {
      result += text.substr(0, length);
    } else {
      const auto byte = static_cast<unsigned char>(text[0]);
      (((result += "\\x") += kDigits[byte >> 4]) += kDigits[byte & 15]);
    }
    text.remove_prefix(length);
  }
  return result;
}

}  // namespace cerberus
