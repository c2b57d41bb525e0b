// SPDX-License-Identifier: LGPL-2.1-or-later
// One line of JSON, written in order into one string that is used again: no tree, no locale, no allocation
// once warm.
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
  // A complete line, newline included.
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
  // Keys are literals of ours: they need no escapes.
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
  // Rounded to `decimals` places, then the shortest form that reads back as that number. NaN, infinity: null.
  JsonLine& fixed(double value, int decimals) {
    return std::isfinite(value) ? raw(rounded(value, decimals)) : null();
  }
  // Up to `digits` significant digits. NaN, infinity: null.
  JsonLine& significant(double value, int digits) {
    return std::isfinite(value) ? raw(cerberus::text::significant(value, digits)) : null();
  }
  // A literal of ours, too.
  JsonLine& string(std::string_view literal) {
    separate();
    text_ += '"';
    text_ += literal;
    text_ += '"';
    comma_ = true;
    return *this;
  }
  // Any UTF-8.
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
