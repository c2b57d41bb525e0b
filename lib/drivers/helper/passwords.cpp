// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/passwords.h"

#include <algorithm>
#include <string_view>

namespace cerberus::drivers {
namespace {

constexpr std::string_view kHidden = "***";
constexpr std::string_view kBefore = " '-,;&?";  // an option
constexpr std::string_view kOptions[] = {"password=", "passwd=", "pass="};

struct Piece {
  std::size_t begin, end;
};

// The password of `scheme://user:password@host` or `user:password@host`; an empty piece: there is none.
Piece password_in_address(std::string_view text) {
  const auto scheme = text.find("://");
  std::size_t begin = scheme == text.npos ? 0 : scheme + 3;
  const auto at = text.substr(0, text.find('/', begin)).rfind('@');
  if (at == text.npos || at < begin) return {0, 0};
  if (scheme == text.npos) begin = text.substr(0, at).rfind(' ') + 1;  // npos + 1: from the start
  const auto colon = text.find(':', begin);
  return colon < at ? Piece{colon + 1, at} : Piece{0, 0};
}

// The value of a word `password=VALUE`, which may be quoted.
Piece password_in_options(std::string_view text) {
  for (const std::string_view option : kOptions)
    for (std::size_t at = text.find(option); at != text.npos; at = text.find(option, at + 1)) {
      const bool begins = at == 0 || kBefore.find(text[at - 1]) != kBefore.npos;
      const std::size_t begin = at + option.size();
      const bool quoted = (at > 0 && text[at - 1] == '\'') || (begin < text.size() && text[begin] == '\'');
      if (begins) return {begin, quoted ? text.size() : std::min(text.find(' ', begin), text.size())};
    }
  return {0, 0};
}

bool holds(const Piece& piece) {
  return piece.end > piece.begin;
}

}  // namespace

std::string without_password(const std::string& setting) {
  std::string text = setting;
  for (const auto find : {password_in_address, password_in_options})
    if (const Piece piece = find(text); holds(piece))
      text.replace(piece.begin, piece.end - piece.begin, kHidden);
  return text;
}

std::string refuse_password(const std::string& setting) {
  if (!holds(password_in_address(setting)) && !holds(password_in_options(setting))) return {};
  return "a password is not given in device or device-options, where others can read it: give user=NAME and "
         "password-file=FILE, password-env=VARIABLE or password-credential=NAME in device-options";
}

}  // namespace cerberus::drivers
