// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rule_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <utility>

#include "fusion/rule_check.h"
#include "sensing/angles.h"
#include "text/file.h"
#include "text/toml.h"

namespace cerberus::fusion {

namespace {

using text::TomlValue;
using Kind = TomlValue::Kind;

// Largest rule file in bytes. A rule file has a page or two; a larger file (a video, say) was named by mistake.
constexpr std::size_t kMostBytes = 1 << 20;

constexpr std::array kActions{Action::track,  Action::turn_left, Action::turn_right,
                              Action::search, Action::zero,      Action::hold};

class Reader {
 public:
  explicit Reader(std::string_view source) : source_(source) {}

  RuleTable read(const TomlValue& root) {
    only(root, {"name", "sensors", "precedence", "rule"}, "the file");
    RuleTable table;
    table.name = text(root, "name", std::string(source_));
    if (root.find("sensors"))
      table.sensors = static_cast<int>(whole(*root.find("sensors"), "sensors", 1, kMaxSensors));
    else
      complain(root, "\"sensors\" (how many there are) is missing");
    const std::string precedence = text(root, "precedence", "exact");
    if (precedence == "order")
      table.precedence = Precedence::order;
    else if (precedence != "exact")
      complain(*root.find("precedence"), "unknown precedence \"" + precedence + "\" (exact, order)");
    const TomlValue* rules = root.find("rule");
    const auto is_table = [](const TomlValue& rule) { return rule.is(Kind::table); };
    if (rules == nullptr || rules->list.empty() || !std::ranges::all_of(rules->list, is_table)) {
      complain(rules ? *rules : root, "no [[rule]] found");
      return table;
    }
    for (const TomlValue& rule : rules->list) table.rules.push_back(read_rule(rule, table));
    return table;
  }

  const std::string& errors() const { return errors_; }
  void complain(std::uint32_t line, std::string_view text) {
    if (!errors_.empty()) errors_ += '\n';
    errors_ += source_;
    if (line > 0) errors_ += ':' + std::to_string(line);
    errors_ += ": ";
    errors_ += text;
  }

 private:
  void complain(const TomlValue& node, std::string_view text) { complain(node.line, text); }

  Rule read_rule(const TomlValue& from, const RuleTable& table) {
    only(from, {"number", "name", "camera", "all", "any", "none", "bands", "action", "sweep"}, "a rule");
    Rule rule;
    rule.number = static_cast<int>(table.rules.size()) + 1;
    if (const TomlValue* number = from.find("number"))
      rule.number = static_cast<int>(whole(*number, "number", 1, 1'000'000));
    rule.name = text(from, "name", "rule " + std::to_string(rule.number));
    const std::string camera = text(from, "camera", "any");
    if (camera == "found" || camera == "missing")
      rule.camera = camera == "found" ? Camera::found : Camera::missing;
    else if (camera != "any")
      complain(*from.find("camera"), "unknown camera \"" + camera + "\" (found, missing, any)");
    rule.all = sensors(from, "all", table.sensors);
    rule.any = sensors(from, "any", table.sensors);
    rule.none = sensors(from, "none", table.sensors);

    const TomlValue* bands = from.find("bands");
    if ((bands != nullptr) == (from.find("action") != nullptr)) {
      complain(from, rule.name + " needs either \"action\" or \"bands\"");
    } else if (bands == nullptr) {
      rule.bands.push_back(read_action(from, rule.name));
    } else if (!bands->is(Kind::list)) {
      complain(*bands, "\"bands\" is a list: [ { up-to = -45, action = \"turn-right\" }, ... ]");
    } else {
      for (const TomlValue& band : bands->list) {
        if (band.is(Kind::table))
          rule.bands.push_back(read_band(band, rule.name));
        else
          complain(band, "a band is a table: { up-to = -45, action = \"turn-right\" }");
      }
    }
    return rule;
  }

  Band read_band(const TomlValue& from, const std::string& rule) {
    only(from, {"from", "above", "up-to", "below", "action", "sweep"}, "a band");
    if (from.find("from") && from.find("above")) complain(from, "\"from\" and \"above\" exclude each other");
    if (from.find("up-to") && from.find("below"))
      complain(from, "\"up-to\" and \"below\" exclude each other");
    Band band = read_action(from, rule);
    const auto edge = [&](const char* key, double& limit, bool& included, bool closed) {
      const TomlValue* node = from.find(key);
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
  Band read_action(const TomlValue& from, const std::string& rule) {
    Band band;
    const std::string wanted = text(from, "action", "");
    bool known = false;
    for (const Action action : kActions) {
      if (wanted != name(action)) continue;
      band.action = action;
      known = true;
    }
    if (!known && wanted.empty() && !(from.find("action") != nullptr)) {
      complain(from, rule + ": \"action\" is missing");
    } else if (!known) {
      complain(*from.find("action"),
               "unknown action \"" + wanted + "\" (track, turn-left, turn-right, search, zero, hold)");
    }
    const TomlValue* sweep = from.find("sweep");
    const bool search = known && band.action == Action::search;
    if (sweep != nullptr && known && !search) complain(*sweep, "only a search has a sweep");
    if (!search) return band;
    if (sweep == nullptr || sweep->list.size() != 2) {
      complain(sweep ? *sweep : from,
               "a search needs the two pan angles it sweeps between: sweep = [-60, 60]");
      return band;
    }
    band.search = {angle(sweep->list[0], "sweep"), angle(sweep->list[1], "sweep")};
    return band;
  }

  SensorBits sensors(const TomlValue& from, const char* key, int count) {
    const TomlValue* node = from.find(key);
    if (node == nullptr) return 0;
    if (!node->is(Kind::list)) {
      complain(*node, std::string("\"") + key + "\" is a list of sensor numbers: [1, 3]");
      return 0;
    }
    SensorBits bits = 0;
    for (const TomlValue& sensor : node->list) {
      const auto number = whole(sensor, "a sensor", 1, count > 0 ? count : kMaxSensors);
      bits = static_cast<SensorBits>(bits | 1U << (number - 1));
    }
    return bits;
  }

  std::int64_t whole(const TomlValue& node, std::string_view what, int least, int most) {
    if (node.is(Kind::integer) && node.integer >= least && node.integer <= most) return node.integer;
    complain(node, std::string(what) + " is a whole number from " + std::to_string(least) + " to " +
                       std::to_string(most));
    return least;
  }

  double angle(const TomlValue& node, std::string_view what) {
    if (node.is_number() && std::abs(node.number) <= 3600)
      return sensing::radians(node.number);  // false for NaN
    complain(node, std::string(what) + " is a pan angle in degrees");
    return 0;
  }

  std::string text(const TomlValue& from, const char* key, std::string otherwise) {
    const TomlValue* node = from.find(key);
    if (node == nullptr) return otherwise;
    if (node->is(Kind::text)) return node->text;
    complain(*node, std::string("\"") + key + "\" is a text in quotes");
    return otherwise;
  }

  void only(const TomlValue& table, std::initializer_list<std::string_view> known, std::string_view where) {
    for (const text::TomlMember& member : table.members) {
      if (std::ranges::find(known, member.key) == known.end())
        complain(member.line, "unknown key \"" + member.key + "\" in " + std::string(where));
    }
  }

  std::string_view source_;
  std::string errors_;
};

RuleFile failure(std::string error) {
  return {std::nullopt, std::move(error)};
}

}  // namespace

RuleFile parse_rules(std::string_view text, std::string_view source) {
  Reader reader(source);
  const text::TomlFile file = text::parse_toml(text);
  if (!file.root) reader.complain(file.mistake.line, file.mistake.text);
  RuleTable table = file.root ? reader.read(*file.root) : RuleTable{};
  if (!reader.errors().empty()) return failure(reader.errors());
  for (const RuleProblem& problem : check(table)) reader.complain(0, problem.text);
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
