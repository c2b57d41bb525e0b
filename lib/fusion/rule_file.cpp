// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rule_file.h"

#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "fusion/rule_check.h"
#include "sensing/angles.h"
#include "text/file.h"

// toml++ checks some properties of its input by assertions (an abort) or, with NDEBUG, assumes them (undefined
// behaviour), and some malformed files violate them: "[&", or "]" where a value belongs (marzer/tomlplusplus issues 294
// and 301, in 3.3). A mistyped rule file must not end a process: here the assertions throw, like its other errors, and
// parse() catches all of them.
namespace cerberus::fusion {
namespace {
struct ParserLost {};
[[noreturn]] void parser_lost() {
  throw ParserLost();
}
}  // namespace
}  // namespace cerberus::fusion
#undef NDEBUG
#define TOML_ASSERT(expression) ((expression) ? void() : ::cerberus::fusion::parser_lost())
#define TOML_EXCEPTIONS 1
#define TOML_HEADER_ONLY 1
#define TOML_ENABLE_FORMATTERS 0
#include <toml++/toml.h>

namespace cerberus::fusion {

namespace {

// Largest rule file in bytes. A rule file has a page or two; a larger file (a video, say) was named by mistake.
constexpr std::size_t kMostBytes = 1 << 20;

constexpr std::array kActions{Action::track,  Action::turn_left, Action::turn_right,
                              Action::search, Action::zero,      Action::hold};

class Reader {
 public:
  explicit Reader(std::string_view source) : source_(source) {}

  RuleTable read(const toml::table& root) {
    only(root, {"name", "sensors", "precedence", "rule"}, "the file");
    RuleTable table;
    table.name = text(root, "name", std::string(source_));
    if (root.contains("sensors"))
      table.sensors = static_cast<int>(whole(*root.get("sensors"), "sensors", 1, kMaxSensors));
    else
      complain(root, "\"sensors\" (how many there are) is missing");
    const std::string precedence = text(root, "precedence", "exact");
    if (precedence == "order")
      table.precedence = Precedence::order;
    else if (precedence != "exact")
      complain(*root.get("precedence"), "unknown precedence \"" + precedence + "\" (exact, order)");
    const toml::node* rules = root.get("rule");
    if (rules == nullptr || !rules->is_array_of_tables()) {
      complain(rules ? *rules : root, "no [[rule]] found");
      return table;
    }
    for (const toml::node& rule : *rules->as_array())
      table.rules.push_back(read_rule(*rule.as_table(), table));
    return table;
  }

  const std::string& errors() const { return errors_; }
  void complain(toml::source_position at, std::string_view text) {
    if (!errors_.empty()) errors_ += '\n';
    errors_ += source_;
    if (at.line > 0) errors_ += ':' + std::to_string(at.line);
    errors_ += ": ";
    errors_ += text;
  }

 private:
  void complain(const toml::node& node, std::string_view text) { complain(node.source().begin, text); }

  Rule read_rule(const toml::table& from, const RuleTable& table) {
    only(from, {"number", "name", "camera", "all", "any", "none", "bands", "action", "sweep"}, "a rule");
    Rule rule;
    rule.number = static_cast<int>(table.rules.size()) + 1;
    if (const toml::node* number = from.get("number"))
      rule.number = static_cast<int>(whole(*number, "number", 1, 1'000'000));
    rule.name = text(from, "name", "rule " + std::to_string(rule.number));
    const std::string camera = text(from, "camera", "any");
    if (camera == "found" || camera == "missing")
      rule.camera = camera == "found" ? Camera::found : Camera::missing;
    else if (camera != "any")
      complain(*from.get("camera"), "unknown camera \"" + camera + "\" (found, missing, any)");
    rule.all = sensors(from, "all", table.sensors);
    rule.any = sensors(from, "any", table.sensors);
    rule.none = sensors(from, "none", table.sensors);

    const toml::node* bands = from.get("bands");
    if ((bands != nullptr) == from.contains("action")) {
      complain(from, rule.name + " needs either \"action\" or \"bands\"");
    } else if (bands == nullptr) {
      rule.bands.push_back(read_action(from, rule.name));
    } else if (!bands->is_array()) {
      complain(*bands, "\"bands\" is a list: [ { up-to = -45, action = \"turn-right\" }, ... ]");
    } else {
      for (const toml::node& band : *bands->as_array()) {
        if (const toml::table* entry = band.as_table())
          rule.bands.push_back(read_band(*entry, rule.name));
        else
          complain(band, "a band is a table: { up-to = -45, action = \"turn-right\" }");
      }
    }
    return rule;
  }

  Band read_band(const toml::table& from, const std::string& rule) {
    only(from, {"from", "above", "up-to", "below", "action", "sweep"}, "a band");
    if (from.contains("from") && from.contains("above"))
      complain(from, "\"from\" and \"above\" exclude each other");
    if (from.contains("up-to") && from.contains("below"))
      complain(from, "\"up-to\" and \"below\" exclude each other");
    Band band = read_action(from, rule);
    const auto edge = [&](const char* key, double& limit, bool& included, bool closed) {
      const toml::node* node = from.get(key);
      if (node == nullptr) return;
      limit = angle(*node, key);
      included = closed;
    };
    edge("from", band.lower, band.lower_included, true);
    edge("above", band.lower, band.lower_included, false);
    edge("up-to", band.upper, band.upper_included, true);
    edge("below", band.upper, band.upper_included, false);
    return band;
  }

  // Reads action and sweep of a band, or of a rule with only one band.
  Band read_action(const toml::table& from, const std::string& rule) {
    Band band;
    const std::string wanted = text(from, "action", "");
    bool known = false;
    for (const Action action : kActions) {
      if (wanted != name(action)) continue;
      band.action = action;
      known = true;
    }
    if (!known && wanted.empty() && !from.contains("action")) {
      complain(from, rule + ": \"action\" is missing");
    } else if (!known) {
      complain(*from.get("action"),
               "unknown action \"" + wanted + "\" (track, turn-left, turn-right, search, zero, hold)");
    }
    const toml::node* sweep = from.get("sweep");
    const bool search = known && band.action == Action::search;
    if (sweep != nullptr && known && !search) complain(*sweep, "only a search has a sweep");
    if (!search) return band;
    const toml::array* ends = sweep != nullptr ? sweep->as_array() : nullptr;
    if (ends == nullptr || ends->size() != 2) {
      complain(sweep ? *sweep : from,
               "a search needs the two pan angles it sweeps between: sweep = [-60, 60]");
      return band;
    }
    band.search = {angle((*ends)[0], "sweep"), angle((*ends)[1], "sweep")};
    return band;
  }

  SensorBits sensors(const toml::table& from, const char* key, int count) {
    const toml::node* node = from.get(key);
    if (node == nullptr) return 0;
    const toml::array* list = node->as_array();
    if (list == nullptr) {
      complain(*node, std::string("\"") + key + "\" is a list of sensor numbers: [1, 3]");
      return 0;
    }
    SensorBits bits = 0;
    for (const toml::node& sensor : *list) {
      const auto number = whole(sensor, "a sensor", 1, count > 0 ? count : kMaxSensors);
      bits = static_cast<SensorBits>(bits | 1U << (number - 1));
    }
    return bits;
  }

  std::int64_t whole(const toml::node& node, std::string_view what, int least, int most) {
    const toml::value<std::int64_t>* value = node.as_integer();
    if (value != nullptr && value->get() >= least && value->get() <= most) return value->get();
    complain(node, std::string(what) + " is a whole number from " + std::to_string(least) + " to " +
                       std::to_string(most));
    return least;
  }

  double angle(const toml::node& node, std::string_view what) {
    const std::optional<double> degrees = node.is_number() ? node.value<double>() : std::nullopt;
    if (degrees && std::abs(*degrees) <= 3600) return sensing::radians(*degrees);  // false for NaN
    complain(node, std::string(what) + " is a pan angle in degrees");
    return 0;
  }

  std::string text(const toml::table& from, const char* key, std::string otherwise) {
    const toml::node* node = from.get(key);
    if (node == nullptr) return otherwise;
    if (const toml::value<std::string>* value = node->as_string()) return value->get();
    complain(*node, std::string("\"") + key + "\" is a text in quotes");
    return otherwise;
  }

  void only(const toml::table& table, std::initializer_list<std::string_view> known, std::string_view where) {
    for (const auto& [key, node] : table) {
      bool found = false;
      for (const std::string_view name : known) found = found || key.str() == name;
      if (!found)
        complain(key.source().begin,
                 "unknown key \"" + std::string(key.str()) + "\" in " + std::string(where));
    }
  }

  std::string_view source_;
  std::string errors_;
};

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

// Parses the text; reports an error and returns nullopt if it is not TOML.
std::optional<toml::table> parse(std::string_view text, std::string_view source, Reader& reader) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
  if (const toml::source_index line = line_of_foreign_letter(text); line != 0) {
    reader.complain({line, 1}, "letters beyond ASCII stand in quotes or comments only");
    return std::nullopt;
  }
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    reader.complain(error.source().begin, error.description());
  } catch (const ParserLost&) {
    reader.complain(toml::source_position{},
                    "this is not TOML: a value, a key or a bracket is missing or misplaced");
  } catch (const std::exception& error) {
    reader.complain(toml::source_position{}, error.what());
  }
  return std::nullopt;
}

RuleFile failure(std::string error) {
  return {std::nullopt, std::move(error)};
}

}  // namespace

RuleFile parse_rules(std::string_view text, std::string_view source) {
  Reader reader(source);
  const std::optional<toml::table> root = parse(text, source, reader);
  RuleTable table = root ? reader.read(*root) : RuleTable{};
  if (!reader.errors().empty()) return failure(reader.errors());
  for (const RuleProblem& problem : check(table)) reader.complain(toml::source_position{}, problem.text);
  if (!reader.errors().empty()) return failure(reader.errors());
  return {std::move(table), ""};
}

RuleFile load_rules(const std::string& path) {
  using Fault = text::File::Fault;
  const text::File file = text::read_file(path, kMostBytes);
  switch (file.fault) {
    case Fault::failed:
      return failure(path + ": " + std::strerror(file.error));
    case Fault::irregular:
      return failure(path + ": a rule file is a regular file");
    case Fault::too_large:
      return failure(path + ": too long for a rule file");
    case Fault::none:
      break;
  }
  return parse_rules(file.text, path);
}

}  // namespace cerberus::fusion
