// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rules.h"

#include <algorithm>
#include <cmath>

#include "sensing/angles.h"

namespace cerberus::fusion {

namespace {

using sensing::radians;

Band up_to(double degrees, bool included, Action action) {
  return {.upper = radians(degrees), .upper_included = included, .action = action};
}
Band from(double degrees, bool included, Action action) {
  return {.lower = radians(degrees), .lower_included = included, .action = action};
}

// "If alpha <= left Then Turn to Right; If alpha >= right Then Turn to Left; Else Camera Tracking", rules 2 to 4.
std::vector<Band> turning_at(double left, double right) {
  return {up_to(left, true, Action::turn_right), from(right, true, Action::turn_left), {}};
}
// The same with < and >, rules 5 and 6.
std::vector<Band> tracking_at(double left, double right) {
  return {up_to(left, false, Action::turn_right), from(right, false, Action::turn_left), {}};
}

RuleTable make_paper_rules() {
  constexpr SensorBits infer1 = 1, infer2 = 2, infer3 = 4;
  RuleTable table{.name = "paper", .sensors = 3, .precedence = Precedence::order, .rules = {}};
  const auto add = [&table](int number, Camera camera, SensorBits all, SensorBits none,
                            std::vector<Band> bands) {
    table.rules.push_back({.number = number,
                           .name = "rule " + std::to_string(number),
                           .camera = camera,
                           .all = all,
                           .any = 0,
                           .none = none,
                           .bands = std::move(bands)});
  };
  add(1, Camera::found, 0, 0, {{}});
  add(5, Camera::any, infer1 | infer2, 0, tracking_at(-90, 0));
  add(6, Camera::any, infer1 | infer3, 0, tracking_at(0, 120));
  add(2, Camera::any, infer1, 0, turning_at(-45, 45));
  add(3, Camera::any, infer2, 0, turning_at(-120, -60));
  add(4, Camera::any, infer3, 0, turning_at(60, 120));
  add(7, Camera::missing, 0, infer1 | infer2 | infer3, {{.action = Action::zero}});
  return table;
}

}  // namespace

std::string_view name(Action action) {
  switch (action) {
    case Action::track:
      return "track";
    case Action::turn_left:
      return "turn-left";
    case Action::turn_right:
      return "turn-right";
    case Action::search:
      return "search";
    case Action::zero:
      return "zero";
    case Action::hold:
      break;
  }
  return "hold";
}

bool Band::unlimited() const {
  return std::isinf(lower) && lower < 0 && std::isinf(upper) && upper > 0;
}

bool Band::holds(double pan) const {
  if (unlimited()) return true;
  const bool above = lower_included ? pan >= lower : pan > lower;
  const bool below = upper_included ? pan <= upper : pan < upper;
  return above && below;
}

bool Rule::matches(bool camera_found, SensorBits fired) const {
  if (camera != Camera::any && (camera == Camera::found) != camera_found) return false;
  return (fired & all) == all && (any == 0 || (fired & any) != 0) && (fired & none) == 0;
}

const Band* Rule::band(double pan) const {
  const auto found = std::ranges::find_if(bands, [pan](const Band& band) { return band.holds(pan); });
  return found == bands.end() ? nullptr : &*found;
}

RuleTable::Match RuleTable::evaluate(bool camera_found, SensorBits fired, double pan) const {
  for (const Rule& rule : rules) {
    if (!rule.matches(camera_found, fired)) continue;
    if (const Band* band = rule.band(pan)) return {&rule, band};
  }
  return {};
}

const RuleTable& paper_rules() {
  static const RuleTable table = make_paper_rules();
  return table;
}

}  // namespace cerberus::fusion
