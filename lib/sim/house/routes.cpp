// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/routes.h"

#include <charconv>
#include <cmath>
#include <optional>

#include "sensing/angles.h"

namespace cerberus::sim {
namespace {

struct Limits {
  double slowest, fastest;  // metres a second
  const char* text;
};
constexpr Limits kRobot{.05, 1.5, ".05 to 1.5"}, kPerson{.1, 4, ".1 to 4"};

// The part before the next separator, which is taken off with it.
std::string_view cut(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

std::vector<std::string_view> words_of(std::string_view text) {
  std::vector<std::string_view> words;
  constexpr char kSpaces[] = " \t\r\n";
  while (true) {
    const std::size_t begin = text.find_first_not_of(kSpaces);
    if (begin == text.npos) return words;
    text.remove_prefix(begin);
    const std::size_t end = std::min(text.find_first_of(kSpaces), text.size());
    words.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
}

// The words after the first one as numbers; nothing: one of them is none, or they are too few or too many.
std::optional<std::vector<double>> numbers(const std::vector<std::string_view>& words, std::size_t least,
                                           std::size_t most) {
  if (words.size() < least + 1 || words.size() > most + 1) return std::nullopt;
  std::vector<double> values;
  for (std::size_t i = 1; i < words.size(); ++i) {
    double value = 0;
    const char* last = words[i].data() + words[i].size();
    const auto [end, error] = std::from_chars(words[i].data(), last, value);
    if (error != std::errc() || end != last || !std::isfinite(value)) return std::nullopt;
    values.push_back(value);
  }
  return values;
}

// Adds a statement to the route; a text: what it should have been.
std::string add(Route& route, bool first, const std::vector<std::string_view>& words, Mover mover) {
  const std::string_view what = words.front();
  if (first != (what == "at")) return "at X Y [HEADING], first of all and only once";
  RouteStep step;
  if (what == "at") {
    const auto at = numbers(words, 2, 3);
    if (!at) return "at X Y [HEADING]";
    route.begin = {(*at)[0], (*at)[1]};
    route.heading = at->size() > 2 ? sensing::radians((*at)[2]) : 0;
    return {};
  }
  if (what == "go") {
    const Limits& limits = mover == Mover::robot ? kRobot : kPerson;
    const auto to = numbers(words, 2, 3);
    if (!to || (to->size() > 2 && ((*to)[2] < limits.slowest || (*to)[2] > limits.fastest)))
      return "go X Y [SPEED], " + std::string(limits.text) + " metres a second";
    step.kind = RouteStep::go;
    step.to = {(*to)[0], (*to)[1]};
    step.speed = to->size() > 2 ? (*to)[2] : 0;
  } else if (what == "turn" && mover == Mover::robot) {
    const auto angle = numbers(words, 1, 1);
    if (!angle) return "turn DEGREES";
    step.kind = RouteStep::turn;
    step.angle = sensing::radians((*angle)[0]);
  } else if (what == "wait" || (what == "gesture" && mover == Mover::person)) {
    const auto seconds = numbers(words, 1, 1);
    if (!seconds || !((*seconds)[0] > 0)) return std::string(what) + " SECONDS, above 0";
    step.kind = what == "wait" ? RouteStep::wait : RouteStep::gesture;
    step.seconds = (*seconds)[0];
  } else {
    return mover == Mover::robot ? "one of at, go, turn, wait" : "one of at, go, wait, gesture";
  }
  route.steps.push_back(step);
  return {};
}

}  // namespace

std::variant<std::vector<Route>, std::string> read_routes(std::string_view text, Mover mover) {
  std::vector<Route> routes;
  while (!text.empty()) {
    std::string_view rest = cut(text, mover == Mover::person ? '|' : '\0');
    Route route;
    bool first = true;
    while (!rest.empty()) {
      const std::string_view statement = cut(rest, ';');
      const auto words = words_of(statement);
      if (words.empty()) continue;
      if (const std::string wanted = add(route, first, words, mover); !wanted.empty())
        return "'" + std::string(statement) + "' should be " + wanted;
      first = false;
    }
    if (!first) routes.push_back(std::move(route));
  }
  return routes;
}

}  // namespace cerberus::sim
