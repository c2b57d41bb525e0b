// SPDX-License-Identifier: LGPL-2.1-or-later
// A floor of a building: rooms and corridors joined by doorways, with furniture, pillars and lamps. Metres; x to the right
// and y downwards as on a drawing, z up from the floor.
//
// One statement a line, names before their use; # begins a comment:
//
//   room NAME X Y WIDTH LENGTH [height=2.7] [wall=T] [floor=T] [ceiling=T]       a corner and the size
//   corridor ...                                                                the same
//   doorway NAME NAME at=M [width=.9] [height=2.05] [wall=T] [floor=T]           through the wall between both; at: x or y
//   box X Y WIDTH LENGTH HEIGHT [from=0] [side=T] [top=T]                        furniture; from: above the floor
//   pillar X Y RADIUS [wall=T]                                                  up to the ceiling
//   lamp X Y [strength=1] [off=S] [on=S]                                        below the ceiling; switched at these seconds
//
// T: plaster, brick, wood, carpet, tiles, concrete, panels, books, cloth, metal.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace cerberus::sim {

enum class Surface { plaster, brick, wood, carpet, tiles, concrete, panels, books, cloth, metal };
inline constexpr int kSurfaces = 10;
std::optional<Surface> surface_of(std::string_view name);

struct Rectangle {
  double left = 0, top = 0, right = 0, bottom = 0;
  bool contains(double x, double y) const { return x >= left && x <= right && y >= top && y <= bottom; }
};

// Where a side of a space leads into another one.
struct Opening {
  enum Side { left, top, right, bottom };
  Side side;
  double from = 0, to = 0;  // along the side
  int space = 0;            // behind it
};

// A room, a corridor, or the inside of a doorway.
struct Space {
  std::string name;
  bool doorway = false;
  Rectangle area;
  double height = 2.7;
  Surface wall = Surface::plaster, floor = Surface::carpet, ceiling = Surface::panels;
  std::vector<Opening> openings;
  std::vector<int> boxes, pillars;  // those that stand here
};

struct Furniture {
  Rectangle area;
  double from = 0, height = 0;
  Surface side = Surface::wood, top = Surface::wood;
};

struct Pillar {
  double x = 0, y = 0, radius = 0;
  Surface wall = Surface::concrete;
};

struct Lamp {
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  double x = 0, y = 0, strength = 1;
  int space = 0;
  bool on = true;
  double off_at = kNever, on_at = kNever;  // seconds; one that is first switched on is dark before
  bool lit(double seconds) const {
    return off_at <= on_at ? seconds < off_at || seconds >= on_at : seconds >= on_at && seconds < off_at;
  }
};

struct FloorPlan {
  std::vector<Space> spaces;
  std::vector<Furniture> boxes;
  std::vector<Pillar> pillars;
  std::vector<Lamp> lamps;
  // The space around a place; -1: none.
  int space_at(double x, double y) const;
};

// The plan, or what is wrong with the text and in which line.
std::variant<FloorPlan, std::string> read_floor_plan(std::string_view text);

}  // namespace cerberus::sim
