// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/tables/table_reader.h"

#include <algorithm>
#include <cmath>

#include "text/numbers.h"

namespace cerberus::robot {

using text::TomlValue;
using Kind = TomlValue::Kind;

namespace {

std::string digits(double value) {
  return text::significant(value, 10).string();
}

std::string range(double least, double most) {
  return "from " + digits(least) + " to " + digits(most);
}

std::vector<std::string_view> words(std::string_view list) {
  std::vector<std::string_view> all;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find(' '), list.size());
    all.push_back(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
  }
  return all;
}

}  // namespace

const TomlValue* TableReader::take(const char* key) {
  known_.push_back(key);
  return table_.find(key);
}

std::uint32_t TableReader::line(const char* key) const {
  for (const text::TomlMember& member : table_.members)
    if (member.key == key) return member.line;
  return table_.line;
}

void TableReader::lines(const std::string& prefix, Lines& into) const {
  for (const text::TomlMember& member : table_.members) into[prefix + member.key] = member.line;
}

void TableReader::complain(const char* key, const std::string& text) {
  mistakes_.push_back({line(key), text});
}

bool TableReader::wrong(const char* key, const std::string& what) {
  const TomlValue* is = table_.find(key);
  complain(key, std::string("\"") + key + "\" of " + where_ + " is " + what +
                    (is ? ", and not " + text::as_written(*is) : ""));
  return false;
}

bool TableReader::text(const char* key, std::string& value) {
  const TomlValue* node = take(key);
  if (node == nullptr) return false;
  if (!node->is(Kind::text)) return wrong(key, "a text in quotes");
  const auto is_control = [](char letter) { return letter >= 0 && letter < ' '; };
  if (std::ranges::any_of(node->text, is_control)) return wrong(key, "one line without control characters");
  value = node->text;
  return true;
}

bool TableReader::truth(const char* key, bool& value) {
  const TomlValue* node = take(key);
  if (node == nullptr) return false;
  if (!node->is(Kind::boolean)) return wrong(key, "true or false");
  value = node->boolean;
  return true;
}

bool TableReader::whole(const char* key, int& value, int least, int most) {
  const TomlValue* node = take(key);
  if (node == nullptr) return false;
  if (!node->is(Kind::integer) || node->integer < least || node->integer > most)
    return wrong(key, "a whole number " + range(least, most));
  value = static_cast<int>(node->integer);
  return true;
}

bool TableReader::number(const char* key, double& value, double least, double most) {
  const TomlValue* node = take(key);
  if (node == nullptr) return false;
  if (!node->is_number() || !(node->number >= least && node->number <= most))  // NaN is in no range
    return wrong(key, "a number " + range(least, most));
  value = node->number;
  return true;
}

bool TableReader::choice(const char* key, std::size_t& index, std::span<const std::string_view> choices) {
  const TomlValue* node = take(key);
  if (node == nullptr) return false;
  const auto found = std::ranges::find(choices, node->text);
  if (node->is(Kind::text) && found != choices.end()) {
    index = static_cast<std::size_t>(found - choices.begin());
    return true;
  }
  std::string all;
  for (const std::string_view one : choices) (all += all.empty() ? "\"" : ", \"").append(one) += '"';
  return wrong(key, "one of " + all);
}

bool TableReader::texts(const char* key, std::vector<std::string>& value) {
  const TomlValue* node = take(key);
  if (node == nullptr) return false;
  const auto is_text = [](const TomlValue& one) { return one.is(Kind::text); };
  if (!node->is(Kind::list) || !std::ranges::all_of(node->list, is_text))
    return wrong(key, "a list of texts: [\"...\", \"...\"]");
  value.clear();
  for (const TomlValue& one : node->list) value.push_back(one.text);
  return true;
}

bool TableReader::text_or_texts(const char* key, std::vector<std::string>& value) {
  const TomlValue* node = table_.find(key);
  if (node == nullptr || !node->is(Kind::text)) return texts(key, value);
  return text(key, value.emplace_back());
}

const TomlValue* TableReader::table(const char* key) {
  const TomlValue* node = take(key);
  if (node == nullptr || node->is(Kind::table)) return node;
  complain(key, std::string("\"") + key + "\" of " + where_ + " is a table of its own");
  return nullptr;
}

std::vector<const TomlValue*> TableReader::tables(const char* key, const char* example) {
  std::vector<const TomlValue*> all;
  const TomlValue* node = take(key);
  if (node == nullptr) return all;
  const auto is_table = [](const TomlValue& one) { return one.is(Kind::table); };
  if (!node->is(Kind::list) || !std::ranges::all_of(node->list, is_table)) {
    wrong(key, std::string("a list of tables: ") + example);
    return all;
  }
  for (const TomlValue& one : node->list) all.push_back(&one);
  return all;
}

void TableReader::properties(std::span<const Option> options, Properties& into) {
  for (const Option& option : options) {
    std::string value;
    double figure = 0;
    bool truth_value = false;
    std::size_t index = 0;
    bool given = false;
    switch (option.kind) {
      case Option::Kind::text:
        given = text(option.key, value);
        break;
      case Option::Kind::truth:
        given = truth(option.key, truth_value);
        value = truth_value ? "true" : "false";
        break;
      case Option::Kind::whole: {
        int integer = 0;
        given = whole(option.key, integer, static_cast<int>(option.least), static_cast<int>(option.most));
        value = std::to_string(integer);
        break;
      }
      case Option::Kind::number:
        given = number(option.key, figure, option.least, option.most);
        value = text::exact(figure).string();
        break;
      case Option::Kind::seconds:
        given = number(option.key, figure, option.least, option.most);
        value = std::to_string(std::llround(figure * 1e9));
        break;
      case Option::Kind::choice: {
        const std::vector<std::string_view> all = words(option.choices);
        given = choice(option.key, index, all);
        value = all[index];
        break;
      }
    }
    if (given) into.push_back({option.key, std::move(value), line(option.key)});
  }
}

void TableReader::finish() {
  for (const text::TomlMember& member : table_.members) {
    if (std::ranges::find(known_, member.key) != known_.end()) continue;
    std::string text = "unknown key \"" + member.key + "\" in " + where_;
    if (const std::string_view meant = text::nearest_key(member.key, known_); !meant.empty())
      text += ": is \"" + std::string(meant) + "\" meant?";
    mistakes_.push_back({member.line, std::move(text)});
  }
}

}  // namespace cerberus::robot
