// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes one line of JSON in order into one reused string: no tree, no locale, no allocation in the steady state.
#pragma once

#include <charconv>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>

#include "text/numbers.h"

namespace cerberus::text {

class JsonLine {
 public:
  void clear() {
    text_.clear();
    comma_ = false;
  }
  // Returns the complete line, newline included.
  std::string_view finish() {
    text_ += '\n';
    return text_;
  }

  JsonLine& open(char bracket) {
    separate();
    text_ += bracket;
    comma_ = false;
    return *this;
  }
  JsonLine& close(char bracket) {
    text_ += bracket;
    comma_ = true;
    return *this;
  }
  // Writes a key. Keys are literals of this program and are not escaped.
  JsonLine& key(std::string_view name) {
    separate();
    text_ += '"';
    text_ += name;
    text_ += "\":";
    comma_ = false;
    return *this;
  }

  JsonLine& null() { return raw("null"); }
  JsonLine& boolean(bool value) { return raw(value ? "true" : "false"); }
  JsonLine& integer(std::integral auto value) {
    char digits[24];
    return raw({digits, std::to_chars(digits, digits + sizeof digits, value).ptr});
  }
  // Writes a number rounded to `decimals` places in the shortest form that reads back as it. NaN, infinity: null.
  JsonLine& fixed(double value, int decimals) {
    return std::isfinite(value) ? raw(rounded(value, decimals)) : null();
  }
  // Writes a number with up to `digits` significant digits. NaN, infinity: null.
  JsonLine& significant(double value, int digits) {
    return std::isfinite(value) ? raw(cerberus::text::significant(value, digits)) : null();
  }
  // Writes a string literal of this program, which is not escaped either.
  JsonLine& string(std::string_view literal) {
    separate();
    text_ += '"';
    text_ += literal;
    text_ += '"';
    comma_ = true;
    return *this;
  }
  // Writes any UTF-8 text, escaped.
  JsonLine& text(std::string_view words) {
    separate();
    text_ += '"';
    for (const char letter : words) {
      if (letter == '"' || letter == '\\') text_ += '\\';
      if (letter >= 0 && letter < ' ') {
        constexpr char kDigits[] = "0123456789abcdef";
        text_ += "\\u00";
        text_ += kDigits[letter >> 4];
        text_ += kDigits[letter & 15];
      } else {
        text_ += letter;
      }
    }
    text_ += '"';
    comma_ = true;
    return *this;
  }

 private:
  void separate() {
    if (comma_) text_ += ',';
  }
  JsonLine& raw(std::string_view token) {
    separate();
    text_ += token;
    comma_ = true;
    return *this;
  }

  std::string text_;
  bool comma_ = false;  // a separator is due before the next token
};

}  // namespace cerberus::text
