// SPDX-License-Identifier: LGPL-2.1-or-later
// A floor plan in small, seen from above: rooms, doorways and furniture; the robot with its way and what its camera
// sees; and the people.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::overlay {

// Metres, x to the right and y downwards. A doorway is a room of its own between two.
struct FloorPlan {
  struct Area {
    double left = 0, top = 0, right = 0, bottom = 0;
  };
  struct Pillar {
    double x = 0, y = 0, radius = 0;
  };
  std::vector<Area> rooms, furniture;
  std::vector<Pillar> pillars;
  std::vector<Area> high;  // furniture that the camera does not see over
};

// Metres of the plan; radians clockwise from x.
struct FloorScene {
  struct Person {
    double x = 0, y = 0;
    bool visible = false;  // the camera sees them
  };
  double x = 0, y = 0, heading = 0;    // of the robot
  double view = 0, field_of_view = 0;  // the camera's axis, and the angle over the picture's width
  std::span<const Person> people;
};

class FloorMap {
 public:
  // For the corner of a picture of this size. Nothing is drawn where there is no room for it: size() is {0, 0}.
  FloorMap(FloorPlan plan, vision::Size frame);
  vision::Size size() const { return size_; }
  // picture: of size(), words of premultiplied alpha, red, green and blue from the highest byte down. The robot's way is
  // that of all calls so far.
  void draw(const FloorScene& scene, vision::View<std::uint32_t> picture);

 private:
  void draw_ground();

  FloorPlan plan_;
  vision::Size size_;
  double left_ = 0, top_ = 0, scale_ = 1;  // metres, and pixels a metre
  std::vector<std::uint32_t> ground_;      // the plan, drawn once
  struct Point {
    double x, y;
  };
  std::vector<Point> way_;
};

}  // namespace cerberus::overlay
