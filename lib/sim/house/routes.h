// SPDX-License-Identifier: LGPL-2.1-or-later
// What robots and people do in a simulated house, as text: steps separated by ';', routes of several people by '|'. A
// route is repeated from its first step.
//
//   at X Y [HEADING]    where it begins; always the first. Metres; degrees clockwise from x
//   go X Y [SPEED]      along a free way; metres a second, as usual if it is missing
//   turn DEGREES        positive to the right; robots only
//   wait SECONDS
//   gesture SECONDS     with a hand above the head; people only
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "sim/house/ways.h"

namespace cerberus::sim {

struct RouteStep {
  enum Kind { go, turn, wait, gesture } kind = wait;
  Spot to;
  double speed = 0;  // metres a second; 0: as usual
  double angle = 0;  // radians
  double seconds = 0;
};

struct Route {
  Spot begin;
  double heading = 0;  // radians
  std::vector<RouteStep> steps;
};

enum class Mover { robot, person };

// The routes (none of an empty text), or what is wrong with the text.
std::variant<std::vector<Route>, std::string> read_routes(std::string_view text, Mover mover);

}  // namespace cerberus::sim
