// SPDX-License-Identifier: LGPL-2.1-or-later
#include "patrol_rows.h"

#include <algorithm>
#include <cstdio>
#include <random>

namespace cerberus::bench {
namespace {

// One thing differs from the first row.
constexpr PatrolRow kRows[] = {
    {"crosses at 1 m/s, robot stands", Robot::stands, Way::crosses, 1, true},
    {"at .1 m/s", Robot::stands, Way::crosses, .1},
    {"at .5 m/s", Robot::stands, Way::crosses, .5},
    {"at 2 m/s", Robot::stands, Way::crosses, 2},
    {"at 4 m/s", Robot::stands, Way::crosses, 4},
    {"approaches", Robot::stands, Way::approaches},
    {"robot drives .6 m/s", Robot::drives, Way::crosses},
    {"robot turns 45 degrees/s", Robot::turns, Way::crosses, 1, true},
    {"robot drives and turns", Robot::drives_and_turns, Way::crosses},
    {"approaches in the corridor", Robot::stands, Way::along_hall},
    {"walks ahead, robot drives", Robot::drives, Way::walks_ahead, .6},
    {"comes through the doorway", Robot::stands, Way::through_door},
    {"two side by side approach", Robot::stands, Way::side_by_side},
    {"three cross", Robot::stands, Way::three_cross},
    {"from behind, robot drives", Robot::drives, Way::from_behind},
    {"nobody, robot stands", Robot::stands, Way::nobody, 1},
    {"nobody, robot drives", Robot::drives, Way::nobody, 1, true},
    {"nobody, robot turns", Robot::turns, Way::nobody, 1, true},
    {"nobody, drives and turns", Robot::drives_and_turns, Way::nobody, 1},
};

using Random = std::mt19937;

double between(Random& random, double from, double to) {
  return from + (to - from) * (random() / 4294967296.);
}

std::string text(const char* format, auto... values) {
  char out[200];
  std::snprintf(out, sizeof out, format, values...);
  return out;
}

// To and fro before the robot, which is at (2.5, 7) and looks along x. A robot that drives is kept ahead of.
std::string crossing(Random& random, const PatrolRow& row, double away, double side) {
  const double x = away + between(random, -.4, .4), start_late = between(random, .2, 1);
  // Who is fast needs 4 m to become so; who is slow begins at the picture's edge, which is .58 of the distance aside.
  const double aside = row.speed >= 2 ? 6.2 : .58 * (x - 2.5) + std::min(.3 + 1.5 * row.speed, 2.5);
  const double ahead = row.robot == Robot::drives ? 7 : row.robot == Robot::drives_and_turns ? 4 : 0;
  const double across = row.robot == Robot::drives ? 10 : 12;
  return text("at %.2f %.2f %.0f; wait %.2f; go %.2f %.2f %.2f", x, 7 - side * aside, 90 * side, start_late,
              x + ahead, 7 + side * std::min(across - aside, 6.2), row.speed);
}

std::string walks(const PatrolRow& row, Random& random) {
  const double side = random() % 2 ? 1 : -1, shift = between(random, -.4, .4);
  const double late = between(random, .2, 1);
  switch (row.way) {
    case Way::nobody:
      return {};
    case Way::crosses:
      return crossing(random, row, 7.5, side);
    case Way::approaches:
      return text("at %.2f %.2f 180; wait %.2f; go 4.5 7 %.2f", 12.5 + shift, 7 + side * shift, late,
                  row.speed);
    case Way::along_hall:
      return text("at %.2f 15.3 180; wait %.2f; go 3.5 15.3 %.2f", 11.5 + shift, late, row.speed);
    case Way::walks_ahead:
      return text("at 4.5 %.2f; go 23 15.3 %.2f", 15.3 + shift / 2, between(random, .5, .7));
    case Way::through_door:
      return text("at %.2f 15.3; wait %.2f; go 9 15 %.2f; go 9 12 %.2f; go %.2f 11 %.2f", 9 + side * 4, late,
                  row.speed, row.speed, 9 + side * 3, row.speed);
    case Way::side_by_side: {
      const auto one = [&](double y) {
        return text("at %.2f %.2f 180; wait %.2f; go 4.5 %.2f %.2f", 12.5 + shift, y, late, y, row.speed);
      };
      return one(6.45) + " | " + one(7.55);
    }
    case Way::three_cross:
      return crossing(random, row, 6.3, side) + " | " + crossing(random, row, 7.7, -side) + " | " +
             crossing(random, row, 9.1, side);
    case Way::from_behind:
      return text("at %.2f %.2f 180; wait %.2f; go .8 %.2f %.2f", 5.5 + shift, 7 + side * 4,
                  between(random, 1, 3), 7 + side * 4, row.speed);
  }
  return {};
}

std::string path(const PatrolRow& row) {
  const bool in_hall = row.way == Way::walks_ahead || row.way == Way::along_hall;
  switch (row.robot) {
    case Robot::stands:
      return row.way == Way::through_door ? "at 9 7.5 90; wait 1"
             : in_hall                    ? "at 1.5 15.3; wait 1"
                                          : "at 2.5 7; wait 1";
    case Robot::drives:
      return in_hall ? "at 1.5 15.3; go 22 15.3" : "at 2.5 7; go 13 7";
    case Robot::turns:
      return "at 2.5 7 -45; turn 90; turn -90";
    case Robot::drives_and_turns:  // legs of 1.8 m, 30 degrees to the right and to the left
      return "at 2.5 7 -30; go 4.06 6.1; go 5.62 7; go 7.18 6.1; go 8.74 7; go 10.3 6.1";
  }
  return {};
}

}  // namespace

std::span<const PatrolRow> patrol_rows() {
  return kRows;
}

std::string scene(const PatrolRow& row, unsigned seed) {
  Random random(seed * 7919);
  const std::string who = walks(row, random);
  return "seed=" + std::to_string(seed) + " path=\"" + path(row) + "\" " +
         (who.empty() ? "people=0" : "walks=\"" + who + "\"");
}

}  // namespace cerberus::bench
