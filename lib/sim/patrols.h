// SPDX-License-Identifier: LGPL-2.1-or-later
// Robots with PIR sensors around them among warm things that stand, and a person who comes. Radians, metres, seconds;
// bearings to the right.
//
//   around   stands
//   patrol   turns by 90 degrees to and fro every 4.5 s: 45 a second, 90 a second squared, rests of 2 s
//   drive    goes straight ahead at .5 m/s
//   hall     as drive, with twice the things
//   warm     as patrol, with warm things in every direction: the turn triggers every sensor
//   cool     as patrol, without any
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/pir_sensor.h"

namespace cerberus::sim {

inline constexpr const char* kPatrols[] = {"around", "cool", "patrol", "warm", "drive", "hall"};

struct Patrol {
  struct Thing {
    double x = 0, y = 0;  // ahead and to the right of where the robot begins
    double width = 0, contrast = 0;
  };
  std::string name;
  std::function<double(double)> yaw = [](double) { return 0.; };
  double speed = 0;  // straight ahead: only where the yaw is 0
  std::vector<Thing> things;

  // The person: `distance` away, at an angle from where it came, which grows and shrinks.
  double comes = 0;  // seconds
  double distance = 0, width = .5, contrast = 6;
  double first = 0;  // from the camera's axis at that moment: out of the picture
  std::function<double(double)> walked = [](double) { return 0.; };  // radians, at seconds since it came

  // Things as seen from the body at a time, without the person.
  void look(double seconds, std::vector<Warmth>& seen) const;
  Warmth person(double bearing) const;
};

// The patrol of that name. What differs between runs differs by the seed.
Patrol patrol(const std::string& name, unsigned seed);

}  // namespace cerberus::sim
