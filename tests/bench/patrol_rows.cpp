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

// Into the picture from one side, 8 m away, then straight towards the robot; beside that way by so many metres.
std::string approach(Random& random, double side, double beside, double speed) {
  const double x = 10.5 + between(random, -.4, .4), late = between(random, .2, 1);
  return text("at %.2f %.2f %.0f; wait %.2f; go %.2f %.2f %.2f; go %.2f %.2f %.2f", x + side * beside,
              7 - side * 5.3 + beside, 90 * side, late, x + side * beside, 7 - side * 4 + beside, speed,
              4.2 + side * beside, 7 - side * .8 + beside, speed);
}

// side: from which a person comes, 1: from the left.
std::string walks(const PatrolRow& row, Random& random, double side) {
  const double shift = between(random, -.4, .4);
  const double late = between(random, .2, 1);
  switch (row.way) {
    case Way::nobody:
      return {};
    case Way::crosses:
      return crossing(random, row, 7.5, side);
    case Way::approaches:
      return approach(random, side, 0, row.speed);
    case Way::along_hall:  // out of the doorway
      return text("at %.2f 12.5 90; wait %.2f; go 9 15.3 %.2f; go 3.5 15.3 %.2f", 9 + shift / 2, late,
                  row.speed, row.speed);
    case Way::walks_ahead: {
      const double speed = between(random, .5, .7);
      return text("at %.2f 12.5 90; wait %.2f; go 9 15.3 1; go 23 15.3 %.2f", 9 + shift / 2, late, speed);
    }
    case Way::through_door:
      return text("at %.2f 15.3; wait %.2f; go 9 15 %.2f; go 9 12 %.2f; go %.2f 11 %.2f", 9 + side * 4, late,
                  row.speed, row.speed, 9 + side * 3, row.speed);
    case Way::side_by_side: {
      Random same = random;
      return approach(random, side, -.55, row.speed) + " | " + approach(same, side, .55, row.speed);
    }
    case Way::three_cross:
      return crossing(random, row, 6.3, side) + " | " + crossing(random, row, 7.7, -side) + " | " +
             crossing(random, row, 9.1, side);
    case Way::from_behind:
      return text("at %.2f %.2f 180; wait %.2f; go .8 %.2f %.2f", 8.5 + shift, 7 + side * 4,
                  between(random, 4, 6), 7 + side * 4, row.speed);
  }
  return {};
}

std::string path(const PatrolRow& row, double side) {
  const bool in_hall = row.way == Way::walks_ahead || row.way == Way::along_hall;
  switch (row.robot) {
    case Robot::stands:
      return row.way == Way::through_door ? "at 9 7.5 90; wait 1"
             : in_hall                    ? "at 1.5 15.3; wait 1"
                                          : "at 2.5 7; wait 1";
    case Robot::drives:
      return in_hall ? "at 4 15.3; go 22 15.3" : "at 2.5 7; go 13 7";
    case Robot::turns:
      // At first away from where the person comes.
      return text("at 2.5 7 %.0f; turn %.0f; turn %.0f", 45 * side, -90 * side, 90 * side);
    case Robot::drives_and_turns: {  // legs of 1.8 m, 30 degrees to the right and to the left
      std::string legs = text("at 2.5 7 %.0f", 30 * side);
      for (int i = 1; i <= 5; ++i)
        legs += text("; go %.2f %.2f", 2.5 + 1.56 * i, i % 2 == 1 ? 7 + .9 * side : 7);
      return legs;
    }
  }
  return {};
}

}  // namespace

std::span<const PatrolRow> patrol_rows() {
  return kRows;
}

std::string scene(const PatrolRow& row, unsigned seed) {
  Random random(seed * 7919);
  const double side = random() % 2 ? 1 : -1;
  const std::string who = walks(row, random, side);
  return "seed=" + std::to_string(seed) + " path=\"" + path(row, side) + "\" " +
         (who.empty() ? "people=0" : "walks=\"" + who + "\"");
}

}  // namespace cerberus::bench
