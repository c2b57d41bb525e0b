// SPDX-License-Identifier: LGPL-2.1-or-later
#include "text/toml.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "text/numbers.h"

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

// toml++ 3.3 has undefined behaviour for letters beyond ASCII where none belongs (is_non_ascii_horizontal_whitespace
// reaches what it calls unreachable for U+00A1 to U+049A; found by tests/fuzz). It is therefore given ASCII alone: each
// byte beyond it, and each "~", becomes "~" and two digits of base 16. TOML has a place for "~" in strings and comments
// only, as for such letters.
std::string encode(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 || c == '~')
      out.append({'~', digits[byte >> 4], digits[byte & 15]});
    else
      out += c;
  }
  return out;
}

// The text of which encode() made `text`, or a message that cites a part of it.
std::string decode(std::string_view text) {
  constexpr std::string_view digits = "0123456789abcdef";
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool encoded = text[i] == '~' && i + 2 < text.size();
    const std::size_t high = encoded ? digits.find(text[i + 1]) : digits.npos;
    const std::size_t low = encoded ? digits.find(text[i + 2]) : digits.npos;
    // No other pair of digits comes from encode().
    if (high != digits.npos && low != digits.npos && (high >= 8 || (high == 7 && low == 14))) {
      out += static_cast<char>(high << 4 | low);
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

// The length of the sequence of UTF-8 at the beginning of `text` (RFC 3629, 4), which is not empty; 0: there is none.
std::size_t sequence_length(std::string_view text) {
  const auto byte = [&](std::size_t at) { return static_cast<unsigned char>(text[at]); };
  const unsigned char first = byte(0);
  const std::size_t length = first < 0x80                    ? 1
                             : first >= 0xc2 && first < 0xe0 ? 2
                             : first >= 0xe0 && first < 0xf0 ? 3
                             : first >= 0xf0 && first < 0xf5 ? 4
                                                             : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80) return 0;
  // Forms that are longer than they need be, surrogates, and what lies beyond U+10FFFF.
  if ((first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) > 0x9f) ||
      (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) > 0x8f))
    return 0;
  return length;
}

// The line of the first byte that is no UTF-8; 0: there is none.
toml::source_index line_of_wrong_byte(std::string_view text) {
  toml::source_index line = 1;
  while (!text.empty()) {
    const std::size_t length = sequence_length(text);
    if (length == 0) return line;
    if (text.front() == '\n') ++line;
    text.remove_prefix(length);
  }
  return 0;
}

// The line of an escape of "~" (\u007e, \U0000007e), which decode() would take for one that encode() made; 0: there is
// none.
toml::source_index line_of_escaped_tilde(std::string_view text) {
  const auto is_tilde = [](std::string_view digits) {
    return digits.starts_with("007e") || digits.starts_with("007E");
  };
  toml::source_index line = 1;
  std::size_t backslashes = 0;  // that stand before
  for (std::size_t i = 0; i < text.size(); ++i) {
    const std::string_view rest = text.substr(i + 1);
    if (backslashes % 2 == 1 && ((text[i] == 'u' && is_tilde(rest)) ||
                                 (text[i] == 'U' && rest.starts_with("0000") && is_tilde(rest.substr(4)))))
      return line;
    backslashes = text[i] == '\\' ? backslashes + 1 : 0;
    if (text[i] == '\n') ++line;
  }
  return 0;
}

// Whether a letter beyond ASCII stands at a place of a text that encode() made.
bool foreign_letter(std::string_view encoded, toml::source_position place) {
  for (toml::source_index line = 1; line < place.line; ++line) {
    const std::size_t end = encoded.find('\n');
    if (end == encoded.npos) return false;
    encoded.remove_prefix(end + 1);
  }
  if (place.column == 0 || place.column + 1 >= encoded.size()) return false;
  const std::string_view at = encoded.substr(place.column - 1);
  return at.front() == '~' && at[1] >= '8';
}

TomlValue convert(const toml::node& node) {
  using Kind = TomlValue::Kind;
  TomlValue value;
  value.line = node.source().begin.line;
  if (const toml::table* table = node.as_table()) {
    for (const auto& [key, child] : *table)
      value.members.push_back({decode(key.str()), key.source().begin.line, convert(child)});
  } else if (const toml::array* list = node.as_array()) {
    value.kind = Kind::list;
    for (const toml::node& child : *list) value.list.push_back(convert(child));
  } else if (const auto* text = node.as_string()) {
    value.kind = Kind::text;
    value.text = decode(text->get());
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

// A text as one short line of printable letters, without the user and the password of an address: whatever the mistake is,
// nothing between // and the last @ is shown.
std::string shown(std::string_view text) {
  constexpr std::size_t kMost = 60;
  std::string whole(text);
  const std::size_t user = whole.find("//"), host = whole.rfind('@');
  if (user != whole.npos && host != whole.npos && user + 2 < host)
    whole.replace(user + 2, host - user - 2, "...");
  text = whole;
  const bool cut = text.size() > kMost;
  std::size_t size = cut ? kMost : text.size();
  while (cut && size > 0 && (static_cast<unsigned char>(text[size]) & 0xc0) == 0x80)
    --size;  // a whole letter
  std::string line(text.substr(0, size));
  std::ranges::replace_if(line, [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; }, '?');
  return cut ? line + "..." : line;
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

namespace {

// With what stands in the line, which a description alone does not say.
TomlMistake mistake_at(std::string_view text, std::uint32_t line, std::string what) {
  std::string_view there = text;
  for (std::uint32_t k = 1; k < line; ++k) {
    const std::size_t end = there.find('\n');
    there.remove_prefix(end == there.npos ? there.size() : end + 1);
  }
  there = there.substr(0, there.find('\n'));
  const std::size_t begin = there.find_first_not_of(" \t\r"), end = there.find_last_not_of(" \t\r");
  if (line == 0 || begin == there.npos) return {line, std::move(what)};
  there = there.substr(begin, end + 1 - begin);
  // The value of a key of such a name is a secret: no message shows it.
  const std::size_t sign = there.find('=');
  const bool secret =
      std::ranges::any_of(std::array<std::string_view, 3>{"pass", "secret", "token"},
                          [&](std::string_view word) { return there.find(word) != there.npos; });
  if (secret && sign != there.npos)
    return {line, what + "; the line begins with: " + shown(there.substr(0, sign))};
  return {line, what + "; the line is: " + shown(there)};
}

// toml++ loses its place with some mistakes: the line is that of the shortest beginning in which it does so too.
std::uint32_t line_where_lost(std::string_view encoded) {
  constexpr std::uint32_t kMost = 1000;  // lines; each is parsed with all before it
  std::size_t end = 0;
  for (std::uint32_t line = 1; line <= kMost && end != encoded.npos; ++line) {
    end = encoded.find('\n', end == 0 ? 0 : end + 1);
    try {
      static_cast<void>(toml::parse(encoded.substr(0, end)));
    } catch (const ParserLost&) {
      return line;
    } catch (const std::exception&) {
    }
  }
  return 0;
}

}  // namespace

TomlFile parse_toml(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  if (const toml::source_index line = line_of_wrong_byte(text); line != 0)
    return {std::nullopt, {line, "this is not UTF-8: save the file in that encoding"}};
  if (const toml::source_index line = line_of_escaped_tilde(text); line != 0)
    return {std::nullopt, {line, "write ~ itself instead of \\u007e"}};
  const std::string encoded = encode(text);
  try {
    return {convert(toml::parse(encoded)), {}};
  } catch (const toml::parse_error& error) {
    const toml::source_position place = error.source().begin;
    if (foreign_letter(encoded, place))
      return {std::nullopt,
              mistake_at(text, place.line, "letters beyond ASCII stand in quotes or comments only")};
    return {std::nullopt, mistake_at(text, place.line, decode(error.description()))};
  } catch (const ParserLost&) {
    return {std::nullopt,
            mistake_at(text, line_where_lost(encoded),
                       "this is not TOML: a value, a key or a bracket is missing or misplaced")};
  } catch (const std::exception& error) {
    return {std::nullopt, {0, error.what()}};
  }
}

std::string as_written(const TomlValue& value) {
  using Kind = TomlValue::Kind;
  switch (value.kind) {
    case Kind::boolean:
      return value.boolean ? "true" : "false";
    case Kind::integer:
      return std::to_string(value.integer);
    case Kind::number:
      return significant(value.number, 10).string();
    case Kind::text:
      return '"' + shown(value.text) + '"';
    case Kind::list:
      return value.list.empty() ? "an empty list" : "a list";
    case Kind::table:
      return "a table";
    case Kind::time:
      break;
  }
  return "a time";
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
