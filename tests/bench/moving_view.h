// SPDX-License-Identifier: LGPL-2.1-or-later
// What a camera would see that moves before a recorded scene: a window of three quarters of its width and height, drawn
// anew from each picture. No pose is published; the camera's motion must be estimated.
#pragma once

#include "boxes.h"
#include "vision/geometry/transform.h"
#include "vision/geometry/warp.h"
#include "vision/image/image.h"

namespace cerberus::bench {

enum class CameraMotion {
  rest,   // at a place that the phase chooses
  pan,    // to and fro, a quarter of the window's width a second
  tilt,   // up and down, by 15 % of the scene's height in all
  zoom,   // in and out by a quarter in 2.4 s, on a path through the scene
  shake,  // as a robot on rough ground: some pixels to and fro, and a degree of roll
};

class MovingView {
 public:
  // phase: 0 to 1, where in its motion the camera begins. picture: of the scene, pixels.
  MovingView(CameraMotion motion, double phase, vision::Size picture);

  // Moves the camera to where it is after so many seconds. Comes before the others.
  void set_time(double seconds);
  // The window of this picture; it lives until the next call.
  vision::GrayView render(vision::GrayView picture);
  // Where a box of the scene is in the window, upright, cut by its edges; without area where it is outside.
  vision::Box to_window(const vision::Box& box) const;
  // Share of the box's area that is inside.
  double visible_share(const vision::Box& box) const;

 private:
  CameraMotion motion_;
  double phase_;  // radians
  vision::Size picture_, window_;
  double scale_ = 1;             // window pixels a pixel of the scene
  vision::Transform to_window_;  // of corner coordinates, like those of boxes
  vision::Warp warp_;
  vision::Image<std::uint8_t> seen_;
};

}  // namespace cerberus::bench
