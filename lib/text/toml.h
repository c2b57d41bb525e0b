// SPDX-License-Identifier: LGPL-2.1-or-later
// A TOML file as a tree of values with their lines. Never throws, and never ends the process on malformed input.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::text {

struct TomlMember;

struct TomlValue {
  enum class Kind : std::uint8_t { boolean, integer, number, text, list, table, time };

  Kind kind = Kind::table;
  std::uint32_t line = 0;  // where it begins, from 1; 0: unknown
  bool boolean = false;
  std::int64_t integer = 0;
  double number = 0;  // of integers, too
  std::string text;
  std::vector<TomlValue> list;
  std::vector<TomlMember> members;  // of a table, by key

  bool is(Kind other) const { return kind == other; }
  bool is_number() const { return kind == Kind::integer || kind == Kind::number; }
  // The value of a table's key; nullptr: there is none.
  const TomlValue* find(std::string_view key) const;
};

struct TomlMember {
  std::string key;
  std::uint32_t line = 0;  // of the key
  TomlValue value;
};

// A mistake in a file; line 0: it has none.
struct TomlMistake {
  std::uint32_t line = 0;
  std::string text;
};

struct TomlFile {
  std::optional<TomlValue> root;  // a table; nullopt: `mistake` has the reason
  TomlMistake mistake;
};

TomlFile parse_toml(std::string_view text);

// A value as a file has it, for a message: a list or a table by its kind, a long text in part.
std::string as_written(const TomlValue& value);

// The known key that `key` is most likely meant to be (at most two letters wrong); empty: none.
std::string_view nearest_key(std::string_view key, const std::vector<std::string_view>& known);

}  // namespace cerberus::text
