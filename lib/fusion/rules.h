// SPDX-License-Identifier: LGPL-2.1-or-later
// The rules of sensor fusion as data: (camera found, infer1..n) x band of pan angles -> action (the paper's II.D).
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "sensing/sectors.h"

namespace cerberus::fusion {

using sensing::kMaxSensors;
using sensing::SensorBits;

enum class Action : std::uint8_t { track, turn_left, turn_right, search, zero, hold };
// "track", "turn-left", "turn-right", "search", "zero", "hold": as in files, messages and JSON.
std::string_view name(Action action);

// A band of pan angles (radians) and its action. Without limits it holds every angle, and an unknown one (NaN).
struct Band {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_included = true, upper_included = true;
  Action action = Action::track;
  sensing::Interval search{};  // pan angles to sweep between, for Action::search

  bool operator==(const Band&) const = default;
  bool unlimited() const;
  bool holds(double pan) const;
};

enum class Camera : std::uint8_t { any, found, missing };

// A rule applies when the camera has the required state, all sensors of `all`, at least one of `any` (if it is not
// empty) and none of `none` detect, and one of the bands holds the pan angle. Bands are if / else-if / else: the first
// one that holds the angle decides.
struct Rule {
  int number = 0;
  std::string name{};
  Camera camera = Camera::any;
  SensorBits all = 0, any = 0, none = 0;
  std::vector<Band> bands{};

  bool operator==(const Rule&) const = default;
  bool matches(bool camera_found, SensorBits fired) const;
  const Band* band(double pan) const;  // nullptr: none holds it
};

enum class Precedence : std::uint8_t {
  order,  // the first rule that applies wins
  exact,  // exactly one answer in every case: check() refuses the table otherwise
};

struct RuleTable {
  std::string name{};
  int sensors = 0;  // number of sensors of the table; detections of further sensors are ignored
  Precedence precedence = Precedence::exact;
  std::vector<Rule> rules{};  // in order of precedence

  bool operator==(const RuleTable&) const = default;
  struct Match {
    const Rule* rule = nullptr;  // nullptr: no rule applies (an unchecked table)
    const Band* band = nullptr;
  };
  // Returns the rule and the band that apply. pan: radians; NaN (unknown) matches unlimited bands only.
  Match evaluate(bool camera_found, SensorBits fired, double pan) const;
};

// Returns the paper's seven rules, literally: by sensor number whatever the bearings, in the order 1, 5, 6, 2, 3, 4, 7,
// first match wins; rules 2-4 turn at their edge and 5-6 track at it. infer2 + infer3 selects rule 3 and all three
// select rule 5: the paper has no rule for these two cases, so this order is a choice of this project.
const RuleTable& paper_rules();

}  // namespace cerberus::fusion
