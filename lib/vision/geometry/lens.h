// SPDX-License-Identifier: LGPL-2.1-or-later
// Converts pixels to directions and places in the room: a pinhole lens with square pixels, turned by pan and tilt,
// mounted above a flat floor.
//
// Angles in radians; pan positive = to the right, tilt and elevation positive = up. Picture coordinates are
// those of boxes: (0, 0) is the top left corner of the top left pixel, the optical axis meets the picture in
// its middle.
//   f = (width / 2) / tan(fov / 2)                            focal length, pixels
//   right = (x - width / 2) / f,  u = (height / 2 - y) / f    ray in the camera's axes; its part ahead is 1
//   up = u cos(tilt) + sin(tilt),  ahead = cos(tilt) - u sin(tilt)       the same ray with the tilt taken out
//   bearing = pan + atan2(right, ahead),  elevation = atan2(up, hypot(right, ahead))
//   floor distance of a point below the horizon = mounting height / tan(-elevation)
#pragma once

#include <optional>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"

namespace cerberus::vision {

struct Direction {
  double bearing = 0;    // [-pi, pi)
  double elevation = 0;  // -pi/2 .. pi/2
};

// The place of an object, as far as lens and floor determine it. NaN = unknown.
struct Placement {
  double bearing;           // of the middle of the box, radians
  double distance;          // along the floor from below the camera to the feet, metres
  double metres_per_pixel;  // across the line of sight at the object
  double width, height;     // of the box at that distance, metres
};

class Lens {
 public:
  // horizontal_fov: radians, over the whole width of the frame, more than 0 and less than pi. Anything else
  // (usually 0 for "unknown") makes a lens of which known() is false and every angle NaN.
  Lens() = default;
  Lens(double horizontal_fov, Size frame);

  bool known() const { return focal_ > 0; }
  double focal_length() const { return focal_; }  // pixels
  Size frame() const { return frame_; }

  // Returns the direction of a point of the picture when the camera points to (pan, tilt).
  Direction direction(Point p, double pan, double tilt) const;

  // Returns the point of the picture, which may lie far outside of it, that shows a direction: direction()'s inverse.
  // Returns nullopt for a direction that is not ahead of the camera, and for an unknown lens.
  std::optional<Point> project(const Direction& d, double pan, double tilt) const;

  // Returns the transform of the picture of a distant scene when the camera turns from one pose to another (radians):
  // from a point's place before to its place after, in the pixel coordinates of Transform. Identity for an unknown
  // lens.
  //   K R(pan after, tilt after)^T R(pan before, tilt before) K^-1,  R = turn to the right by pan x turn up by tilt
  Transform turn(double pan_before, double tilt_before, double pan_after, double tilt_after) const;

  // Returns the distance along the floor, in the unit of the mounting height, of the point of the floor seen at p. NaN
  // on and above the horizon or for a mounting height that is not positive.
  double floor_distance(Point p, double tilt, double mounting_height) const;

  // Returns the placement of a box whose lower edge stands on the floor:
  //   depth = mounting height / -up(foot)      distance along the optical axis, from the ray with ahead = 1
  //   metres per pixel = depth / f,  width = box width x metres per pixel
  //   height = mounting height + distance tan(elevation of the upper edge)              (a vertical object)
  // All but the bearing are NaN where the foot point is not visible: at the picture's lower border or above the
  // horizon.
  Placement place(const Box& box, double pan, double tilt, double mounting_height) const;

 private:
  struct Ray {
    double right, up, ahead;
  };
  Ray ray(Point p, double tilt) const;

  Size frame_;
  double focal_ = 0;
};

}  // namespace cerberus::vision
