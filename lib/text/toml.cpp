// SPDX-License-Identifier: LGPL-2.1-or-later
#include "text/toml.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

// toml++ checks some properties of its input by assertions (an abort) or, with NDEBUG, assumes them (undefined
// behaviour), and some malformed files violate them: "[&", or "]" where a value belongs (marzer/tomlplusplus issues 294
// and 301, in 3.3). A mistyped file must not end a process: here the assertions throw, like its other errors, and
// parse_toml() catches all of them.
namespace cerberus::text {
namespace {
struct ParserLost {};
[[noreturn]] void parser_lost() {
  throw ParserLost();
}
}  // namespace
}  // namespace cerberus::text
#undef NDEBUG
#define TOML_ASSERT(expression) ((expression) ? void() : ::cerberus::text::parser_lost())
#define TOML_EXCEPTIONS 1
#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

namespace cerberus::text {
namespace {

// The line of the first byte beyond ASCII that stands neither in a comment nor in quotes; 0: there is none. TOML has no
// place for one, and toml++ 3.3 has undefined behaviour there (is_non_ascii_horizontal_whitespace reaches what it calls
// unreachable for U+00A1 to U+049A; found by tests/fuzz/rules.cpp).
toml::source_index line_of_foreign_letter(std::string_view text) {
  toml::source_index line = 1;
  std::string_view quotes;  // what ends the string at this place; empty: it is none
  bool comment = false, foreign = false;
  char before = '\n';  // the last character outside of strings that is no blank
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool ascii = static_cast<unsigned char>(c) < 0x80;
    if (c == '\n') {
      if (quotes.size() == 1 && foreign) return line;  // a string that does not end is none
      ++line;
      comment = false;
      before = c;
      if (quotes.size() == 1) quotes = {};
    } else if (comment) {
      continue;
    } else if (!quotes.empty()) {
      foreign = foreign || !ascii;
      if (c == '\\' && quotes.front() == '"' && !text.substr(i + 1).starts_with('\n'))
        ++i;
      else if (text.substr(i).starts_with(quotes))
        i += std::exchange(quotes, {}).size() - 1;
    } else if (!ascii) {
      return line;
    } else if (c == '#') {
      comment = true;
    } else if ((c == '"' || c == '\'') &&
               std::string_view("\n=[,{.").find(before) != std::string_view::npos) {
      const std::string_view triple = text.substr(i, 3);
      quotes = triple.size() == 3 && triple[1] == c && triple[2] == c ? triple : text.substr(i, 1);
      i += quotes.size() - 1;
      foreign = false;
      before = c;
    } else if (c != ' ' && c != '\t' && c != '\r') {
      before = c;
    }
  }
  return !quotes.empty() && foreign ? line : 0;
}

TomlValue convert(const toml::node& node) {
  using Kind = TomlValue::Kind;
  TomlValue value;
  value.line = node.source().begin.line;
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table)
      value.members.push_back({std::string(key.str()), key.source().begin.line, convert(child)});
  } else if (const toml::array* list = node.as_array()) {
    value.kind = Kind::list;
    for (const toml::node& child : *list) value.list.push_back(convert(child));
  } else if (const auto* text = node.as_string()) {
    value.kind = Kind::text;
    value.text = text->get();
  } else if (const auto* truth = node.as_boolean()) {
    value.kind = Kind::boolean;
    value.boolean = truth->get();
  } else if (const auto* whole = node.as_integer()) {
    value.kind = Kind::integer;
    value.integer = whole->get();
    value.number = static_cast<double>(whole->get());
  } else if (const auto* number = node.as_floating_point()) {
    value.kind = Kind::number;
    value.number = number->get();
  } else {
    value.kind = Kind::time;
  }
  return value;
}

// Letters that must be inserted, removed or replaced to make `b` of `a` (Levenshtein), for keys of up to 40 letters.
std::size_t distance(std::string_view a, std::string_view b) {
  std::array<std::size_t, 41> row{};
  if (a.size() >= row.size() || b.size() >= row.size()) return row.size();
  for (std::size_t k = 0; k <= b.size(); ++k) row[k] = k;
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t corner = std::exchange(row[0], i + 1);
    for (std::size_t k = 0; k < b.size(); ++k) {
      const std::size_t replaced = corner + (a[i] == b[k] ? 0 : 1);
      corner = row[k + 1];
      row[k + 1] = std::min({replaced, row[k] + 1, row[k + 1] + 1});
    }
  }
  return row[b.size()];
}

}  // namespace

const TomlValue* TomlValue::find(std::string_view key) const {
  for (const TomlMember& member : members)
    if (member.key == key) return &member.value;
  return nullptr;
}

TomlFile parse_toml(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  if (const toml::source_index line = line_of_foreign_letter(text); line != 0)
    return {std::nullopt, {line, "letters beyond ASCII stand in quotes or comments only"}};
  try {
    return {convert(toml::parse(text)), {}};
  } catch (const toml::parse_error& error) {
    return {std::nullopt, {error.source().begin.line, std::string(error.description())}};
  } catch (const ParserLost&) {
    return {std::nullopt, {0, "this is not TOML: a value, a key or a bracket is missing or misplaced"}};
  } catch (const std::exception& error) {
    return {std::nullopt, {0, error.what()}};
  }
}

std::string_view nearest_key(std::string_view key, const std::vector<std::string_view>& known) {
  std::string_view best;
  std::size_t least = 3;
  for (const std::string_view name : known) {
    const std::size_t wrong = distance(key, name);
    if (wrong < least && wrong < name.size()) {
      least = wrong;
      best = name;
    }
  }
  return best;
}

}  // namespace cerberus::text
