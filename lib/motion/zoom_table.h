// SPDX-License-Identifier: LGPL-2.1-or-later
// What a camera sees at the positions of its zoom: a table of points, and between two of them
//
//   tan(field of view / 2) = t1 (t2 / t1)^((position - p1) / (p2 - p1)),   t = tan(field of view / 2) at a point
//
// because the focal length, to which t is inverse, grows by about the same factor for each step of a zoom's motor.
#pragma once

#include <string>
#include <vector>

namespace cerberus::motion {

// Positions of a zoom: 0 = the widest, 1 = the longest focal length of the lens; a digital zoom goes beyond.
inline constexpr double kMostZoom = 2;

class ZoomTable {
 public:
  // "0 60; 0.5 20; 1 3.2": position and horizontal field of view in degrees (0.1 to 179), positions rising, fields of
  // view falling; 2 to 64 points; an empty text makes an empty table. Returns what is wrong, and changes nothing then.
  std::string parse(const std::string& text);
  bool empty() const { return points_.empty(); }
  // Radians, over the frame's width; beyond the table the nearest end's. 0: the table is empty.
  double field_of_view(double position) const;
  // The position at which the camera sees this (radians): field_of_view()'s inverse; beyond the table the nearest end. 0:
  // the table is empty.
  double position_for(double field_of_view) const;

 private:
  struct Point {
    double position = 0, tangent = 0;  // of half the field of view
  };
  std::vector<Point> points_;
};

}  // namespace cerberus::motion
