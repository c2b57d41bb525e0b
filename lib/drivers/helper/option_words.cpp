// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/option_words.h"

#include <charconv>
#include <cmath>

namespace cerberus::drivers {

OptionWord option_word(std::string_view text) {
  if (text.starts_with("--")) text.remove_prefix(2);
  const std::size_t sign = text.find('=');
  if (sign == text.npos) return {std::string(text), "", false};
  return {std::string(text.substr(0, sign)), std::string(text.substr(sign + 1)), true};
}

std::vector<std::string> quoted_words(std::string_view text) {
  std::vector<std::string> words;
  bool quoted = false, begun = false;
  for (const char c : text) {
    if (c == '\'') quoted = !quoted;
    const bool blank = c == ' ' && !quoted;
    if (!blank && !begun) words.emplace_back();
    begun = !blank;
    if (!blank && c != '\'') words.back() += c;
  }
  return words;
}

std::vector<OptionWord> option_words(std::string_view text) {
  std::vector<OptionWord> words;
  for (const std::string& word : quoted_words(text)) words.push_back(option_word(word));
  return words;
}

std::string flag(const OptionWord& word, bool& on) {
  if (word.has_value) return word.key + "=" + word.value + ": " + word.key + " takes no value";
  on = true;
  return {};
}

std::vector<std::string> split(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.emplace_back(text.substr(begin, end == text.npos ? end : end - begin));
    if (end == text.npos) return parts;
    begin = end + 1;
  }
}

std::vector<std::string> comma_list(std::string_view text) {
  if (text.empty()) return {};
  std::vector<std::string> parts = split(text, ',');
  for (std::string& part : parts) {
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
  }
  return parts;
}

std::optional<double> number_of(std::string_view text) {
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) return std::nullopt;
  return number;
}

}  // namespace cerberus::drivers
