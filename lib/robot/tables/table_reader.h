// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads the keys of one TOML table into typed values; every mistake is kept with its line. A key that no method asked for
// is a mistake as well.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "robot/settings.h"
#include "text/toml.h"

namespace cerberus::robot {

using Mistakes = std::vector<text::TomlMistake>;

// A key of the file that sets the property of the same name of an element.
struct Option {
  enum class Kind : std::uint8_t { text, truth, whole, number, seconds, choice };
  const char* key;
  Kind kind = Kind::text;
  double least = 0, most = 0;  // of numbers; seconds become nanoseconds
  const char* choices = "";    // "a b c"
};

class TableReader {
 public:
  // `where` names the table in mistakes: "[page]". All three outlive the reader.
  TableReader(const text::TomlValue& table, std::string where, Mistakes& mistakes)
      : table_(table), where_(std::move(where)), mistakes_(mistakes) {}

  bool has(std::string_view key) const { return table_.find(key) != nullptr; }
  // Each leaves `value` as it is where the key is missing or wrong. Returns whether it was set.
  bool text(const char* key, std::string& value);
  bool truth(const char* key, bool& value);
  bool whole(const char* key, int& value, int least, int most);
  bool number(const char* key, double& value, double least, double most);
  // Sets `index` to the place of the text in `choices`.
  bool choice(const char* key, std::size_t& index, std::span<const std::string_view> choices);
  bool texts(const char* key, std::vector<std::string>& value);
  bool text_or_texts(const char* key, std::vector<std::string>& value);
  const text::TomlValue* table(const char* key);
  // The tables of a list; `example` says how they are written.
  std::vector<const text::TomlValue*> tables(const char* key, const char* example);
  // Reads all options that are there.
  void properties(std::span<const Option> options, Properties& into);

  // Where a key stands, else where the table begins.
  std::uint32_t line(const char* key) const;
  void complain(const char* key, const std::string& text);
  // Where the keys stand that are there; each begins with `prefix`.
  void lines(const std::string& prefix, Lines& into) const;
  // Complains about the keys that were not asked for.
  void finish();

 private:
  const text::TomlValue* take(const char* key);
  bool wrong(const char* key, const std::string& what);

  const text::TomlValue& table_;
  std::string where_;
  Mistakes& mistakes_;
  std::vector<std::string_view> known_;
};

}  // namespace cerberus::robot
