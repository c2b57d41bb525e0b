// SPDX-License-Identifier: LGPL-2.1-or-later
// The rows of bench-patrol: what a robot and people do for 15 s on the floor of patrol.plan. What differs between seeds:
// clothes, textures and noise, where people begin and in which direction they go.
#pragma once

#include <span>
#include <string>

namespace cerberus::bench {

enum class Robot { stands, drives, turns, drives_and_turns };
enum class Way {
  nobody,
  crosses,       // 5 m before the robot, from out of the picture on one side
  approaches,    // from 8 m to 2 m, after a step into the picture
  along_hall,    // the same in the corridor, out of the doorway
  walks_ahead,   // of the robot, along the corridor at .5 to .7 m/s, after a step out of the doorway
  through_door,  // from the corridor into the room
  side_by_side,  // two approach
  three_cross,   // at different distances, not all in the same direction
  from_behind,   // out of sight beside and behind the robot, as it passes
};

struct PatrolRow {
  const char* name;
  Robot robot;
  Way way;
  double speed = 1;    // of people, m/s
  bool shown = false;  // in the short form
};
std::span<const PatrolRow> patrol_rows();
// Properties of patrolsimsrc.
std::string scene(const PatrolRow& row, unsigned seed);

}  // namespace cerberus::bench
