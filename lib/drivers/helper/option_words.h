// SPDX-License-Identifier: LGPL-2.1-or-later
// Words such as "steps=400 invert" as the drivers of heads take their options.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::drivers {

struct OptionWord {
  std::string key, value;
  bool has_value = false;
};

// One word: "steps=400", "--steps=400" or "invert".
OptionWord option_word(std::string_view text);
// The words of a text, parted by blanks; single quotes keep blanks together, and are left out.
std::vector<std::string> quoted_words(std::string_view text);
std::vector<OptionWord> option_words(std::string_view text);
// A word without a value, which sets `on`. Returns what is wrong; then `on` is unchanged.
std::string flag(const OptionWord& word, bool& on);
// The parts of a list that a character parts; empty parts are kept.
std::vector<std::string> split(std::string_view text, char separator);
// The parts of a list with commas, without blanks around them; none of an empty text.
std::vector<std::string> comma_list(std::string_view text);
// A finite number with a point in every locale; nothing for any other text.
std::optional<double> number_of(std::string_view text);

}  // namespace cerberus::drivers
